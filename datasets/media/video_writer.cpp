// SPDX-License-Identifier: Apache-2.0
#include "datasets/media/video_writer.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <string_view>
#include <utility>

extern "C" {
#include <libavutil/dict.h>
#include <libavutil/opt.h>
}

#include "datasets/media/libav_input.h"
#include "ltm/core/file.h"
#include "ltm/core/log.h"

namespace engram::datasets {

namespace {

constexpr int kMaxSide = 1 << 14;
constexpr int kMaxCrf = 51;
constexpr int kMaxEncoders = 64;
constexpr std::array<std::string_view, 9> kPresets{
    "ultrafast", "superfast", "veryfast", "faster", "fast", "medium", "slow", "slower", "veryslow"};
constexpr int kMaxRateTerm = 1'000'000;
/// Times in MPEG are multiples of 1/90000 s.
constexpr int64_t kTicksPerSecond = 90'000;

/// Rounds to the nearest tick.
int64_t ticks_of(Duration duration) {
  constexpr int64_t kSecond_ns = 1'000'000'000;
  const int64_t ns = duration.count();
  return ns / kSecond_ns * kTicksPerSecond +
         (ns % kSecond_ns * kTicksPerSecond + kSecond_ns / 2) / kSecond_ns;
}

libav::PixelFormat coded_format(const VideoWriter::Options& options) {
  return {.width = options.width,
          .height = options.height,
          .format = options.keeps_chroma ? AV_PIX_FMT_YUV444P : AV_PIX_FMT_YUV420P,
          .matrix = AVCOL_SPC_BT709,
          .is_full_range = false,
          .chroma = AVCHROMA_LOC_LEFT};
}

Result<libav::Codec> open_encoder(const VideoWriter::Options& options) {
  const AVCodec* codec = avcodec_find_encoder_by_name("libx264");
  if (codec == nullptr) return invalid_argument("FFmpeg is installed without libx264");
  libav::Codec encoder(avcodec_alloc_context3(codec));
  if (!encoder) return resource_exhausted("no memory for an encoder");
  const libav::PixelFormat format = coded_format(options);
  encoder->width = format.width;
  encoder->height = format.height;
  encoder->pix_fmt = format.format;
  encoder->time_base = {options.rate_denominator, options.rate_numerator};
  if (options.has_times) {
    encoder->time_base = {1, static_cast<int>(kTicksPerSecond)};
    // With B-frames, images that are far apart in time lie further from their place than demuxers
    // expect.
    encoder->max_b_frames = 0;
  }
  encoder->framerate = {options.rate_numerator, options.rate_denominator};
  encoder->colorspace = format.matrix;
  encoder->color_primaries = AVCOL_PRI_BT709;
  encoder->color_trc = AVCOL_TRC_BT709;
  encoder->color_range = AVCOL_RANGE_MPEG;
  encoder->chroma_sample_location = format.chroma;
  encoder->thread_count = options.threads;
  encoder->flags |= AV_CODEC_FLAG_GLOBAL_HEADER | AV_CODEC_FLAG_BITEXACT;
  av_opt_set(encoder->priv_data, "preset", options.preset.c_str(), 0);
  av_opt_set_int(encoder->priv_data, "crf", options.crf, 0);
  // With macroblock trees, x264 (build 164, AVX-512) gives different bytes for the same images,
  // depending on earlier contents of memory.
  av_opt_set_int(encoder->priv_data, "mbtree", 0, 0);
  if (const int code = avcodec_open2(encoder.get(), codec, nullptr); code < 0)
    return invalid_argument("libx264 refuses {} x {}, preset '{}', crf {}: {}", options.width,
                            options.height, options.preset, options.crf, libav::describe(code));
  return encoder;
}

struct OutputFreer {
  void operator()(AVFormatContext* output) const {
    avio_closep(&output->pb);
    avformat_free_context(output);
  }
};
using Output = std::unique_ptr<AVFormatContext, OutputFreer>;

Status failure(int code, std::string_view what) {
  const auto kind =
      code == AVERROR(ENOSPC) ? StatusCode::kResourceExhausted : StatusCode::kUnavailable;
  return Status(kind, fmt::format("{}: {}", what, libav::describe(code)));
}

void set_metadata(AVFormatContext& output, const VideoWriter::Options& options) {
  if (!options.created) return;
  std::string text = to_string(*options.created) + "Z";
  text[text.find(' ')] = 'T';
  av_dict_set(&output.metadata, "creation_time", text.c_str(), 0);
}

Result<Output> open_output(const std::filesystem::path& file, const AVCodecContext& encoder,
                           const VideoWriter::Options& options) {
  const std::string url = "file:" + file.string();
  AVFormatContext* allocated = nullptr;
  if (const int code = avformat_alloc_output_context2(&allocated, nullptr, "mp4", url.c_str());
      code < 0)
    return failure(code, "cannot make an MP4 file");
  Output output(allocated);
  output->flags |= AVFMT_FLAG_BITEXACT;
  set_metadata(*output, options);
  AVStream* stream = avformat_new_stream(output.get(), nullptr);
  if (stream == nullptr || avcodec_parameters_from_context(stream->codecpar, &encoder) < 0)
    return resource_exhausted("no memory for a stream");
  stream->time_base = encoder.time_base;
  stream->avg_frame_rate = encoder.framerate;
  if (const int code = avio_open(&output->pb, url.c_str(), AVIO_FLAG_WRITE); code < 0)
    return failure(code, "cannot create");
  AVDictionary* flags = nullptr;
  av_dict_set(&flags, "movflags", "+faststart", 0);
  const int code = avformat_write_header(output.get(), &flags);
  av_dict_free(&flags);
  if (code < 0) return failure(code, "cannot write the header");
  return output;
}

Result<libav::Frame> make_frame(const libav::PixelFormat& format) {
  libav::Frame frame(av_frame_alloc());
  if (!frame) return resource_exhausted("no memory for a frame");
  frame->format = format.format;
  frame->width = format.width;
  frame->height = format.height;
  frame->colorspace = format.matrix;
  frame->color_range = format.is_full_range ? AVCOL_RANGE_JPEG : AVCOL_RANGE_MPEG;
  frame->chroma_location = format.chroma;
  if (av_frame_get_buffer(frame.get(), 0) < 0) return resource_exhausted("no memory for a frame");
  return frame;
}

}  // namespace

struct VideoWriter::State {
  ~State();
  Status open();
  Status convert(const idf::NdArray& image);
  Status encode(const AVFrame* picture);
  Status write(const idf::NdArray& image, int64_t tick);
  Status finish();

  /// How long an image is shown according to the rate. Unit: the encoder's time base.
  [[nodiscard]] int64_t image_ticks() const {
    if (!options.has_times) return 1;
    return std::max<int64_t>(1,
                             kTicksPerSecond * options.rate_denominator / options.rate_numerator);
  }

  std::filesystem::path path;
  std::filesystem::path beside;
  Options options;
  libav::Codec encoder;
  Output output;
  libav::Scaler converter;
  libav::Frame padded;  // In RGB.
  libav::Frame frame;   // In the encoder's format.
  libav::Packet packet{av_packet_alloc()};
  int64_t images = 0;
  int64_t last_tick = -1;
};

VideoWriter::State::~State() {
  const bool is_open = output != nullptr;
  output.reset();
  if (!is_open) return;
  if (const Status status = remove_file(beside); !status.ok())
    log::warning("an unfinished video stays: {}", status.message());
}

Status VideoWriter::State::open() {
  const libav::PixelFormat coded = coded_format(options);
  const libav::PixelFormat rgb = libav::rgb_format(options.width, options.height);
  ENGRAM_ASSIGN_OR_RETURN(converter, libav::make_converter(rgb, coded));
  ENGRAM_ASSIGN_OR_RETURN(padded, make_frame(rgb));
  ENGRAM_ASSIGN_OR_RETURN(frame, make_frame(coded));
  ENGRAM_ASSIGN_OR_RETURN(encoder, open_encoder(options));
  if (!packet) return resource_exhausted("no memory for a packet");
  ENGRAM_ASSIGN_OR_RETURN(output, open_output(beside, *encoder, options));
  return {};
}

Status VideoWriter::State::convert(const idf::NdArray& image) {
  const idf::Shape needed{options.height, options.width, 3};
  if (image.type() != idf::ElementType::kUInt8 || image.shape() != needed)
    return invalid_argument("image {} is {} {}, needs uint8 {}", images,
                            idf::to_string(image.type()), idf::to_string(image.shape()),
                            idf::to_string(needed));
  if (av_frame_make_writable(frame.get()) < 0) return resource_exhausted("no memory for a frame");
  // swscale reads whole vectors, beyond the end of an image that has no padding.
  const size_t line = static_cast<size_t>(options.width) * 3;
  for (int y = 0; y < options.height; ++y)
    std::memcpy(padded->data[0] + static_cast<ptrdiff_t>(y) * padded->linesize[0],
                image.values<uint8_t>().data() + static_cast<size_t>(y) * line, line);
  if (const int code = sws_scale(converter.get(), padded->data, padded->linesize, 0, options.height,
                                 frame->data, frame->linesize);
      code < 0)
    return failure(code, "cannot convert colours");
  ++images;
  return {};
}

/// Encodes a picture; if it is null, drains the encoder.
Status VideoWriter::State::encode(const AVFrame* picture) {
  if (const int code = avcodec_send_frame(encoder.get(), picture); code < 0)
    return failure(code, "cannot encode");
  while (true) {
    int code = avcodec_receive_packet(encoder.get(), packet.get());
    if (code == AVERROR(EAGAIN) || code == AVERROR_EOF) return {};
    if (code < 0) return failure(code, "cannot encode");
    // The muxer derives the duration of the last image from this.
    packet->duration = image_ticks();
    av_packet_rescale_ts(packet.get(), encoder->time_base, output->streams[0]->time_base);
    code = av_interleaved_write_frame(output.get(), packet.get());
    if (code < 0) return failure(code, "cannot write");
  }
}

Status VideoWriter::State::write(const idf::NdArray& image, int64_t tick) {
  ENGRAM_CHECK(output != nullptr, "video '{}' is closed", path.string());
  Status status = convert(image);
  last_tick = std::max(tick, last_tick + 1);
  frame->pts = last_tick;
  if (status.ok()) status = encode(frame.get());
  return status.ok() ? status : status.with_context(fmt::format("video '{}'", path.string()));
}

Status VideoWriter::State::finish() {
  ENGRAM_RETURN_IF_ERROR(encode(nullptr));
  if (const int code = av_write_trailer(output.get()); code < 0)
    return failure(code, "cannot write the index");
  if (const int code = avio_closep(&output->pb); code < 0) return failure(code, "cannot close");
  ENGRAM_RETURN_IF_ERROR(publish_file(beside, std::filesystem::absolute(path)));
  output.reset();
  return {};
}

Status VideoWriter::Options::validate() const {
  if (width < 2 || width > kMaxSide || height < 2 || height > kMaxSide)
    return invalid_argument("video writer: size {} x {}, needs 2 to {} pixels", width, height,
                            kMaxSide);
  if (!keeps_chroma && (width % 2 != 0 || height % 2 != 0))
    return invalid_argument("video writer: size {} x {}, needs even numbers or keeps_chroma", width,
                            height);
  if (rate_numerator < 1 || rate_numerator > kMaxRateTerm || rate_denominator < 1 ||
      rate_denominator > kMaxRateTerm)
    return invalid_argument("video writer: rate {} / {}, needs terms of 1 to {}", rate_numerator,
                            rate_denominator, kMaxRateTerm);
  if (crf < 0 || crf > kMaxCrf)
    return invalid_argument("video writer: crf {}, needs 0 to {}", crf, kMaxCrf);
  // The preset is checked here, because libx264 would print its own message.
  if (std::ranges::find(kPresets, preset) == kPresets.end())
    return invalid_argument("video writer: preset '{}', needs 'ultrafast' to 'veryslow'", preset);
  if (threads < 1 || threads > kMaxEncoders)
    return invalid_argument("video writer: {} threads, needs 1 to {}", threads, kMaxEncoders);
  return {};
}

VideoWriter::VideoWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
VideoWriter::VideoWriter(VideoWriter&&) noexcept = default;
VideoWriter& VideoWriter::operator=(VideoWriter&&) noexcept = default;
VideoWriter::~VideoWriter() = default;

Result<VideoWriter> VideoWriter::create(const std::filesystem::path& path, const Options& options) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  libav::keep_quiet();
  auto state = std::make_unique<State>();
  state->path = path;
  state->beside = path.string() + ".new";
  state->options = options;
  if (Status status = state->open(); !status.ok())
    return status.with_context(fmt::format("video '{}'", path.string()));
  return VideoWriter(std::move(state));
}

Status VideoWriter::write(const idf::NdArray& image) {
  return state_->write(image,
                       state_->last_tick + (state_->images == 0 ? 1 : state_->image_ticks()));
}

Status VideoWriter::write(const idf::NdArray& image, Duration since_first) {
  ENGRAM_CHECK(state_->options.has_times, "video '{}' has a fixed rate", state_->path.string());
  return state_->write(image, ticks_of(since_first));
}

Status VideoWriter::close() {
  ENGRAM_CHECK(state_->output != nullptr, "video '{}' is closed", state_->path.string());
  const Status status = state_->finish();
  return status.ok() ? status
                     : status.with_context(fmt::format("video '{}'", state_->path.string()));
}

}  // namespace engram::datasets
