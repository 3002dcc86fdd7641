// SPDX-License-Identifier: Apache-2.0
#include "datasets/video_reader.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

extern "C" {
#include <libavutil/dict.h>
#include <libavutil/mathematics.h>
}

#include "datasets/libav.h"

namespace engram::datasets {

namespace {

constexpr int64_t kNsPerSecond = 1'000'000'000;
constexpr int kMaxSide = 1 << 14;
constexpr int kMaxThreads = 64;
// A decoder that fails this often between two packets or frames will never recover.
constexpr int kMaxErrorsInRow = 64;
// Lengths in headers are rounded, and the last frame may be shown for a while.
constexpr Duration kLengthTolerance = std::chrono::milliseconds(500);
// swscale may write whole vectors: lines are padded to these.
constexpr int kLineAlignment = 64;

double to_double(AVRational rate) {
  return rate.den == 0 ? 0.0 : av_q2d(rate);
}

std::optional<Time> creation_time(const AVFormatContext& input, const AVStream& stream) {
  for (const AVDictionary* metadata : {stream.metadata, input.metadata}) {
    const AVDictionaryEntry* entry = av_dict_get(metadata, "creation_time", nullptr, 0);
    if (entry == nullptr) continue;
    if (auto time = parse_time(entry->value); time.ok()) return *time;
  }
  return std::nullopt;
}

uint64_t approximate_frames(const AVFormatContext& input, const AVStream& stream) {
  if (stream.nb_frames > 0) return static_cast<uint64_t>(stream.nb_frames);
  double seconds = 0;
  if (stream.duration > 0)
    seconds = static_cast<double>(stream.duration) * to_double(stream.time_base);
  else if (input.duration > 0)
    seconds = static_cast<double>(input.duration) / AV_TIME_BASE;
  return static_cast<uint64_t>(std::llround(seconds * to_double(stream.avg_frame_rate)));
}

VideoInfo info_of(const AVFormatContext& input, const AVStream& stream) {
  return {.width = stream.codecpar->width,
          .height = stream.codecpar->height,
          .codec = avcodec_get_name(stream.codecpar->codec_id),
          .rate_hz = to_double(stream.avg_frame_rate),
          .approximate_frames = approximate_frames(input, stream),
          .created = creation_time(input, stream)};
}

/// How much the file says there is to read; zeros where it does not.
struct Announced {
  uint64_t packets = 0;
  Duration length{};
};

Duration duration_of(int64_t ticks, AVRational time_base) {
  return Duration(av_rescale_q(ticks, time_base, AVRational{1, static_cast<int>(kNsPerSecond)}));
}

Announced announced_of(const AVFormatContext& input, AVStream& stream) {
  Announced announced;
  if (stream.nb_frames > 0) announced.packets = static_cast<uint64_t>(stream.nb_frames);
  // An edited MP4 keeps samples that nobody shall see; only those to be read are in the index.
  const int entries = avformat_index_get_entries_count(&stream);
  if (std::string_view(input.iformat->name).starts_with("mov") && entries > 0)
    announced.packets = std::min(announced.packets, static_cast<uint64_t>(entries));
  // With other streams beside it, the file's length may be theirs.
  if (input.nb_streams == 1 && input.duration > 0 &&
      input.duration_estimation_method == AVFMT_DURATION_FROM_STREAM)
    announced.length = duration_of(input.duration, AVRational{1, AV_TIME_BASE});
  return announced;
}

/// What of a picture is cut out.
cv::Rect crop_of(int width, int height, bool crops_square) {
  if (!crops_square) return {0, 0, width, height};
  const int side = std::min(width, height);
  return {(width - side) / 2, (height - side) / 2, side, side};
}

int scaled(int size, int by, int of) {
  return std::max(1, static_cast<int>(std::lround(static_cast<double>(size) * by / of)));
}

cv::Size output_size(const VideoInfo& info, const VideoReader::Options& options) {
  const cv::Size from = crop_of(info.width, info.height, options.crops_square).size();
  if (options.width == 0 && options.height == 0) return from;
  if (options.width == 0) return {scaled(from.width, options.height, from.height), options.height};
  if (options.height == 0) return {options.width, scaled(from.height, options.width, from.width)};
  return {options.width, options.height};
}

Result<libav::Input> open_input(const std::filesystem::path& path) {
  std::error_code error;
  const auto kind = std::filesystem::status(path, error).type();
  if (kind == std::filesystem::file_type::not_found)
    return not_found("video '{}': there is no such file", path.string());
  if (kind != std::filesystem::file_type::regular)
    return invalid_argument("video '{}': needs a file", path.string());
  // "file:" keeps names like "a:b" from being taken for network addresses.
  const std::string url = "file:" + path.string();
  AVFormatContext* opened = nullptr;
  if (const int code = avformat_open_input(&opened, url.c_str(), nullptr, nullptr); code < 0) {
    if (code == AVERROR(EACCES) || code == AVERROR(EMFILE))
      return unavailable("video '{}': cannot open: {}", path.string(), libav::describe(code));
    return invalid_argument("video '{}': is no video, or its index is missing: {}", path.string(),
                            libav::describe(code));
  }
  libav::Input input(opened);
  if (const int code = avformat_find_stream_info(opened, nullptr); code < 0)
    return invalid_argument("video '{}': cannot tell what it holds: {}", path.string(),
                            libav::describe(code));
  return input;
}

/// The stream that plays, not the cover of a song, nor a text that FFmpeg would render.
Result<AVStream*> find_video(AVFormatContext& input, const std::filesystem::path& path) {
  const int index = av_find_best_stream(&input, AVMEDIA_TYPE_VIDEO, -1, -1, nullptr, 0);
  AVStream* stream = index < 0 ? nullptr : input.streams[index];
  if (stream == nullptr || (stream->disposition & AV_DISPOSITION_ATTACHED_PIC) != 0 ||
      stream->codecpar->codec_id == AV_CODEC_ID_ANSI)
    return invalid_argument("video '{}': found {} streams, needs a video stream", path.string(),
                            input.nb_streams);
  const AVCodecParameters& stated = *stream->codecpar;
  if (stated.width <= 0 || stated.height <= 0 || stated.width > kMaxSide ||
      stated.height > kMaxSide)
    return invalid_argument("video '{}': size {} x {}, needs 1 to {} pixels", path.string(),
                            stated.width, stated.height, kMaxSide);
  return stream;
}

Result<libav::Codec> open_decoder(const AVStream& stream, int threads,
                                  const std::filesystem::path& path) {
  const char* name = avcodec_get_name(stream.codecpar->codec_id);
  const AVCodec* codec = avcodec_find_decoder(stream.codecpar->codec_id);
  if (codec == nullptr)
    return invalid_argument("video '{}': no decoder for codec '{}' is installed", path.string(),
                            name);
  libav::Codec decoder(avcodec_alloc_context3(codec));
  if (!decoder || avcodec_parameters_to_context(decoder.get(), stream.codecpar) < 0)
    return resource_exhausted("video '{}': no memory for a decoder", path.string());
  decoder->thread_count = threads;
  decoder->pkt_timebase = stream.time_base;
  // Without it some decoders leave damaged frames out and tell nobody.
  decoder->flags |= AV_CODEC_FLAG_OUTPUT_CORRUPT;
  if (const int code = avcodec_open2(decoder.get(), codec, nullptr); code < 0)
    return invalid_argument("video '{}': cannot decode codec '{}': {}", path.string(), name,
                            libav::describe(code));
  return decoder;
}

/// Decoded frames to RGB images of one size.
class ImageMaker {
 public:
  ImageMaker(cv::Size size, bool crops_square) : size_(size), crops_square_(crops_square) {}

  Result<idf::NdArray> make(const AVFrame& frame) {
    ENGRAM_RETURN_IF_ERROR(prepare(libav::format_of(frame)));
    const std::array<uint8_t*, 1> lines{whole_.data};
    const std::array<int, 1> strides{static_cast<int>(whole_.step)};
    if (sws_scale(converter_.get(), frame.data, frame.linesize, 0, frame.height, lines.data(),
                  strides.data()) != frame.height)
      return invalid_argument("the colours of a frame cannot be converted");
    return fit(whole_(crop_of(frame.width, frame.height, crops_square_)));
  }

 private:
  Status prepare(const libav::PixelFormat& format) {
    if (converter_ && format == format_) return {};
    const int stride = (format.width + kLineAlignment - 1) / kLineAlignment * kLineAlignment;
    ENGRAM_ASSIGN_OR_RETURN(
        converter_, libav::make_converter(format, libav::rgb_format(format.width, format.height)));
    whole_.create(format.height, stride, CV_8UC3);
    format_ = format;
    return {};
  }

  idf::NdArray fit(const cv::Mat& from) const {
    std::vector<uint8_t> pixels(static_cast<size_t>(size_.area()) * 3);
    cv::Mat to(size_, CV_8UC3, pixels.data());
    const bool shrinks = size_.width <= from.cols && size_.height <= from.rows;
    if (from.size() == size_)
      from.copyTo(to);
    else
      cv::resize(from, to, size_, 0, 0, shrinks ? cv::INTER_AREA : cv::INTER_LINEAR);
    return idf::NdArray::take({size_.height, size_.width, 3}, std::move(pixels));
  }

  cv::Size size_;
  bool crops_square_;
  libav::PixelFormat format_;
  libav::Scaler converter_;
  cv::Mat whole_;
};

}  // namespace

struct VideoReader::State {
  State(std::filesystem::path file, libav::Input source, AVStream* video, libav::Codec codec,
        const Options& options)
      : path(std::move(file)),
        input(std::move(source)),
        stream(video),
        decoder(std::move(codec)),
        info(info_of(*input, *video)),
        announced(announced_of(*input, *video)),
        images(output_size(info, options), options.crops_square) {}

  Status feed();
  void note_end();
  void note_reached();
  Result<bool> receive();
  std::optional<Duration> time_of(const AVFrame& decoded);
  Result<std::optional<VideoFrame>> deliver();
  [[nodiscard]] Status broken() const;

  std::filesystem::path path;
  libav::Input input;
  AVStream* stream;  // Of `input`.
  libav::Codec decoder;
  VideoInfo info;
  Announced announced;
  ImageMaker images;
  libav::Packet packet{av_packet_alloc()};
  libav::Frame frame{av_frame_alloc()};
  std::optional<int64_t> origin;  // In the stream's time base.
  std::optional<Duration> last;
  Duration reached{};  // End of the last packet.
  uint64_t packets = 0;
  uint64_t damaged = 0;
  int errors_in_row = 0;
  bool is_draining = false;
  std::string broken_by;  // What next() reports when the decoder is empty.
};

Status VideoReader::State::broken() const {
  const double seconds = last ? to_seconds(*last) : 0.0;
  return data_loss("video '{}': breaks after {:.6f} s, packet {}: {}", path.string(), seconds,
                   packets, broken_by);
}

void VideoReader::State::note_reached() {
  const int64_t stamp = packet->pts != AV_NOPTS_VALUE ? packet->pts : packet->dts;
  if (stamp == AV_NOPTS_VALUE) return;
  const int64_t start = stream->start_time != AV_NOPTS_VALUE ? stream->start_time : 0;
  reached = std::max(reached, duration_of(stamp + packet->duration - start, stream->time_base));
}

/// The file ended; that is only fine where all came that its header announces.
void VideoReader::State::note_end() {
  if (packets < announced.packets)
    broken_by = fmt::format("found {} packets, its index lists {}", packets, announced.packets);
  else if (announced.packets == 0 && reached + kLengthTolerance < announced.length)
    broken_by = fmt::format("found {:.3f} s of packets, its header announces {:.3f} s",
                            to_seconds(reached), to_seconds(announced.length));
}

/// Reads the next packet of the video and hands it to the decoder; at the end, or where the file
/// breaks, asks the decoder for what it still holds.
Status VideoReader::State::feed() {
  int code = 0;
  while ((code = av_read_frame(input.get(), packet.get())) >= 0 &&
         packet->stream_index != stream->index)
    av_packet_unref(packet.get());
  if (code < 0) {
    if (code == AVERROR_EOF)
      note_end();
    else
      broken_by = libav::describe(code);
    is_draining = true;
    avcodec_send_packet(decoder.get(), nullptr);
    return {};
  }
  ++packets;
  errors_in_row = 0;
  note_reached();
  const bool is_torn = (packet->flags & AV_PKT_FLAG_CORRUPT) != 0;
  code = is_torn ? AVERROR_INVALIDDATA : avcodec_send_packet(decoder.get(), packet.get());
  av_packet_unref(packet.get());
  if (code == AVERROR(ENOMEM)) return resource_exhausted("video '{}': no memory", path.string());
  if (code < 0) ++damaged;
  return {};
}

/// Fetches the next decoded frame; false at the end.
Result<bool> VideoReader::State::receive() {
  while (true) {
    const int code = avcodec_receive_frame(decoder.get(), frame.get());
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

/// Nothing where the frame has no time after that of the last one.
std::optional<Duration> VideoReader::State::time_of(const AVFrame& decoded) {
  std::optional<Duration> time;
  if (const int64_t stamp = decoded.best_effort_timestamp; stamp != AV_NOPTS_VALUE) {
    if (!origin) origin = stream->start_time != AV_NOPTS_VALUE ? stream->start_time : stamp;
    time = duration_of(stamp - *origin, stream->time_base);
  } else if (info.rate_hz > 0) {  // Raw streams carry no times.
    const Duration step(std::llround(static_cast<double>(kNsPerSecond) / info.rate_hz));
    time = last ? *last + step : Duration(0);
  }
  if (time && last && *time <= *last) return std::nullopt;
  return time;
}

Result<std::optional<VideoFrame>> VideoReader::State::deliver() {
  while (true) {
    ENGRAM_ASSIGN_OR_RETURN(const bool has_frame, receive());
    if (!has_frame) break;
    const bool is_damaged =
        (frame->flags & AV_FRAME_FLAG_CORRUPT) != 0 || frame->decode_error_flags != 0;
    const std::optional<Duration> time = time_of(*frame);
    if (is_damaged || !time) ++damaged;
    if (!time) continue;
    auto image = images.make(*frame);
    if (!image.ok())
      return image.status().with_context(
          fmt::format("video '{}': frame at {:.6f} s", path.string(), to_seconds(*time)));
    last = time;
    return std::optional(VideoFrame{*time, std::move(image).value(), is_damaged});
  }
  if (!broken_by.empty()) return broken();
  return std::optional<VideoFrame>();
}

Status VideoReader::Options::validate() const {
  if (width < 0 || width > kMaxSide || height < 0 || height > kMaxSide)
    return invalid_argument("video reader: size {} x {}, needs 0 to {} pixels", width, height,
                            kMaxSide);
  if (threads < 1 || threads > kMaxThreads)
    return invalid_argument("video reader: {} threads, needs 1 to {}", threads, kMaxThreads);
  return {};
}

VideoReader::VideoReader(std::unique_ptr<State> state) : state_(std::move(state)) {}
VideoReader::VideoReader(VideoReader&&) noexcept = default;
VideoReader& VideoReader::operator=(VideoReader&&) noexcept = default;
VideoReader::~VideoReader() = default;

Result<VideoReader> VideoReader::open(const std::filesystem::path& path, const Options& options) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  libav::keep_quiet();
  ENGRAM_ASSIGN_OR_RETURN(libav::Input input, open_input(path));
  ENGRAM_ASSIGN_OR_RETURN(AVStream* const stream, find_video(*input, path));
  ENGRAM_ASSIGN_OR_RETURN(libav::Codec decoder, open_decoder(*stream, options.threads, path));
  for (unsigned i = 0; i < input->nb_streams; ++i)
    if (input->streams[i] != stream) input->streams[i]->discard = AVDISCARD_ALL;
  auto state = std::make_unique<State>(path, std::move(input), stream, std::move(decoder), options);
  if (!state->packet || !state->frame)
    return resource_exhausted("video '{}': no memory", path.string());
  return VideoReader(std::move(state));
}

Result<std::optional<VideoFrame>> VideoReader::next() {
  try {
    return state_->deliver();
  } catch (const cv::Exception& error) {
    return invalid_argument("video '{}': cannot scale a frame: {}", state_->path.string(),
                            error.what());
  }
}

const VideoInfo& VideoReader::info() const {
  return state_->info;
}

uint64_t VideoReader::damaged_frames() const {
  return state_->damaged;
}

}  // namespace engram::datasets
