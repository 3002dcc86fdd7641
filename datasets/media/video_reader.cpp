// SPDX-License-Identifier: Apache-2.0
#include "datasets/media/video_reader.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <utility>

#include "datasets/media/decoded_picture.h"
#include "datasets/media/frame_images.h"
#include "datasets/media/video_file.h"

namespace engram::datasets {

namespace {

constexpr int64_t kNsPerSecond = 1'000'000'000;
constexpr int kMaxDecoders = 64;
// A decoder that fails this often without a success in between will not recover.
constexpr int kMaxErrorsInRow = 64;
// Lengths in headers are rounded, and the last frame may be shown for some time.
constexpr Duration kLengthTolerance = std::chrono::milliseconds(500);

}  // namespace

struct VideoReader::State {
  State(std::filesystem::path name, VideoFile opened, const Options& options)
      : path(std::move(name)), file(std::move(opened)), images(file.info, options) {}

  Status feed();
  void note_end();
  void note_reached();
  Result<bool> receive();
  std::optional<Duration> time_of(const AVFrame& decoded);
  Result<std::optional<DecodedFrame>> deliver();
  [[nodiscard]] Status broken() const;

  std::filesystem::path path;
  VideoFile file;
  FrameImages images;
  libav::Packet packet{av_packet_alloc()};
  libav::Frame frame{av_frame_alloc()};
  std::optional<int64_t> origin;  // Unit: the time base of the stream.
  std::optional<Duration> last;
  Duration reached{};  // The end of the last packet.
  uint64_t packets = 0;
  uint64_t damaged = 0;
  int errors_in_row = 0;
  bool is_draining = false;
  std::string broken_by;  // The error that next() returns once the decoder is empty.
};

Status VideoReader::State::broken() const {
  const double seconds = last ? to_seconds(*last) : 0.0;
  return data_loss("video '{}': breaks after {:.6f} s, packet {}: {}", path.string(), seconds,
                   packets, broken_by);
}

void VideoReader::State::note_reached() {
  const int64_t stamp = packet->pts != AV_NOPTS_VALUE ? packet->pts : packet->dts;
  if (stamp == AV_NOPTS_VALUE) return;
  const int64_t start = file.stream->start_time != AV_NOPTS_VALUE ? file.stream->start_time : 0;
  reached =
      std::max(reached, duration_of(stamp + packet->duration - start, file.stream->time_base));
}

/// Notes that the file ended, which is an error if less came than its header announces.
void VideoReader::State::note_end() {
  if (packets < file.announced.packets)
    broken_by =
        fmt::format("found {} packets, its index lists {}", packets, file.announced.packets);
  else if (file.announced.packets == 0 && reached + kLengthTolerance < file.announced.length)
    broken_by = fmt::format("found {:.3f} s of packets, its header announces {:.3f} s",
                            to_seconds(reached), to_seconds(file.announced.length));
}

/// Reads the next packet of the video and passes it to the decoder. At the end, or if the file
/// breaks, flushes the decoder.
Status VideoReader::State::feed() {
  int code = 0;
  while ((code = av_read_frame(file.input.get(), packet.get())) >= 0 &&
         packet->stream_index != file.stream->index)
    av_packet_unref(packet.get());
  if (code < 0) {
    if (code == AVERROR_EOF)
      note_end();
    else
      broken_by = libav::describe(code);
    is_draining = true;
    avcodec_send_packet(file.decoder.get(), nullptr);
    return {};
  }
  ++packets;
  errors_in_row = 0;
  note_reached();
  const bool is_torn = (packet->flags & AV_PKT_FLAG_CORRUPT) != 0;
  code = is_torn ? AVERROR_INVALIDDATA : avcodec_send_packet(file.decoder.get(), packet.get());
  av_packet_unref(packet.get());
  if (code == AVERROR(ENOMEM)) return resource_exhausted("video '{}': no memory", path.string());
  if (code < 0) ++damaged;
  return {};
}

/// Fetches the next decoded frame; returns false at the end.
Result<bool> VideoReader::State::receive() {
  while (true) {
    const int code = avcodec_receive_frame(file.decoder.get(), frame.get());
    if (code >= 0) {
      errors_in_row = 0;
      return true;
    }
    if (code == AVERROR_EOF || (code == AVERROR(EAGAIN) && is_draining)) return false;
    if (code == AVERROR(ENOMEM)) return resource_exhausted("video '{}': no memory", path.string());
    if (code == AVERROR(EAGAIN)) {
      ENGRAM_RETURN_IF_ERROR(feed());
      continue;
    }
    ++damaged;
    if (++errors_in_row <= kMaxErrorsInRow) continue;
    broken_by = fmt::format("the decoder gives up: {}", libav::describe(code));
    return false;
  }
}

/// Returns nothing if the frame's time is not after that of the last frame.
std::optional<Duration> VideoReader::State::time_of(const AVFrame& decoded) {
  std::optional<Duration> time;
  if (const int64_t stamp = decoded.best_effort_timestamp; stamp != AV_NOPTS_VALUE) {
    if (!origin)
      origin = file.stream->start_time != AV_NOPTS_VALUE ? file.stream->start_time : stamp;
    time = duration_of(stamp - *origin, file.stream->time_base);
  } else if (file.info.rate_hz > 0) {  // Raw streams have no times.
    const Duration step(std::llround(static_cast<double>(kNsPerSecond) / file.info.rate_hz));
    time = last ? *last + step : Duration(0);
  }
  if (time && last && *time <= *last) return std::nullopt;
  return time;
}

Result<std::optional<DecodedFrame>> VideoReader::State::deliver() {
  while (true) {
    ENGRAM_ASSIGN_OR_RETURN(const bool has_frame, receive());
    if (!has_frame) break;
    const bool is_damaged =
        (frame->flags & AV_FRAME_FLAG_CORRUPT) != 0 || frame->decode_error_flags != 0;
    const std::optional<Duration> time = time_of(*frame);
    if (is_damaged || !time) ++damaged;
    if (!time) continue;
    last = time;
    auto picture = std::make_shared<DecodedPicture>(*frame);
    if (!picture->is_valid()) return resource_exhausted("video '{}': no memory", path.string());
    return std::optional(DecodedFrame{*time, is_damaged, std::move(picture)});
  }
  if (!broken_by.empty()) return broken();
  return std::optional<DecodedFrame>();
}

Status VideoReader::Options::validate() const {
  if (width < 0 || width > kMaxVideoSide || height < 0 || height > kMaxVideoSide)
    return invalid_argument("video reader: size {} x {}, needs 0 to {} pixels", width, height,
                            kMaxVideoSide);
  if (threads < 1 || threads > kMaxDecoders)
    return invalid_argument("video reader: {} threads, needs 1 to {}", threads, kMaxDecoders);
  return {};
}

VideoReader::VideoReader(std::unique_ptr<State> state) : state_(std::move(state)) {}
VideoReader::VideoReader(VideoReader&&) noexcept = default;
VideoReader& VideoReader::operator=(VideoReader&&) noexcept = default;
VideoReader::~VideoReader() = default;

Result<VideoReader> VideoReader::open(const std::filesystem::path& path, const Options& options) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  libav::keep_quiet();
  ENGRAM_ASSIGN_OR_RETURN(VideoFile file, open_video_file(path, options.threads));
  auto state = std::make_unique<State>(path, std::move(file), options);
  if (!state->packet || !state->frame)
    return resource_exhausted("video '{}': no memory", path.string());
  return VideoReader(std::move(state));
}

Result<std::optional<VideoFrame>> VideoReader::next() {
  ENGRAM_ASSIGN_OR_RETURN(const auto frame, decode());
  if (!frame) return std::optional<VideoFrame>();
  ENGRAM_ASSIGN_OR_RETURN(idf::NdArray image, convert(*frame));
  return std::optional(VideoFrame{frame->time, std::move(image), frame->is_damaged});
}

Result<std::optional<DecodedFrame>> VideoReader::decode() {
  return state_->deliver();
}

Result<idf::NdArray> VideoReader::convert(const DecodedFrame& frame) {
  auto image = state_->images.make(*frame.picture);
  if (!image.ok())
    return image.status().with_context(fmt::format("video '{}': frame at {:.6f} s",
                                                   state_->path.string(), to_seconds(frame.time)));
  return image;
}

idf::Shape VideoReader::image_shape() const {
  return state_->images.shape();
}

const VideoInfo& VideoReader::info() const {
  return state_->file.info;
}

uint64_t VideoReader::damaged_frames() const {
  return state_->damaged;
}

}  // namespace engram::datasets
