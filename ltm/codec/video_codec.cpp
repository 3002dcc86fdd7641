// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/video_codec.h"

extern "C" {
#include <libavutil/mem.h>
#include <libavutil/opt.h>
}

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#include "ltm/codec/video_stream.h"

namespace engram::ltm {

namespace {

constexpr int64_t kMaxVideoSide = 1 << 14;
/// Max number of pixels. A few bytes may announce any size, and decoders allocate it.
constexpr int64_t kMaxPixels = 1 << 26;
/// Max padding of a picture's sides, because codecs pad pictures to whole blocks.
constexpr int64_t kMaxPadding = 128;
constexpr int kMaxGroup = 1024;
constexpr size_t kMaxSetupBytes = 1 << 20;
constexpr int kMaxSpread = 63;
constexpr int kNoKey = -1;

constexpr std::array<const char*, 10> kPresets{"ultrafast", "superfast", "veryfast", "faster",
                                               "fast",      "medium",    "slow",     "slower",
                                               "veryslow",  "placebo"};

constexpr std::array<VideoKind, 4> kKinds{{
    {.name = "ffv1",
     .encoder = "ffv1",
     .decoder = "ffv1",
     .is_lossless = true,
     .min_side = 8,
     .crf = 0,
     .max_crf = 0,
     .effort = 0,
     .max_effort = 0,
     .group = 30},
    {.name = "h264",
     .encoder = "libx264",
     .decoder = "h264",
     .is_lossless = false,
     .min_side = 16,
     .crf = 23,
     .max_crf = 51,
     .effort = 2,
     .max_effort = 9,
     .group = 30},
    {.name = "h265",
     .encoder = "libx265",
     .decoder = "hevc",
     .is_lossless = false,
     .min_side = 16,
     .crf = 26,
     .max_crf = 51,
     .effort = 1,
     .max_effort = 9,
     .group = 30},
    {.name = "av1",
     .encoder = "libaom-av1",
     .decoder = "libdav1d",
     .is_lossless = false,
     .min_side = 16,
     .crf = 32,
     .max_crf = 63,
     .effort = 1,
     .max_effort = 9,
     .group = 30},
}};

struct VideoOptions {
  int crf = 0;
  int effort = 0;
  int group = 1;
  int depth = 8;  ///< Bits that the codec computes with.
  /// How much better than `crf` single pictures may be coded. Unit: steps of crf.
  int spread = kMaxSpread;
  /// The crf of the first picture, and the best one of the others; kNoKey for what libaom chooses.
  int key = kNoKey;
};

void set(AVCodecContext& encoder, const char* key, const std::string& value) {
  // An option that the installed version does not have is ignored.
  av_opt_set(encoder.priv_data, key, value.c_str(), 0);
}

/// Uses one thread and nothing that depends on the clock, so that equal groups give equal bytes.
/// With libx264 this holds nearly always: it reads uninitialised memory for tiny pictures.
void configure(const VideoKind& kind, const VideoOptions& options, AVCodecContext& encoder) {
  if (kind.name == "ffv1") {
    encoder.level = 3;
    set(encoder, "coder", "range_def");
    set(encoder, "context", "0");
    set(encoder, "slicecrc", "1");
    return;
  }
  set(encoder, "crf", std::to_string(options.crf));
  if (kind.name == "av1") {
    encoder.bit_rate = 0;
    // No key frame but the first: where libaom 3.6 looks for cuts, it ends the process with an
    // assertion if a cut follows some 18 still pictures.
    encoder.keyint_min = encoder.gop_size;
    set(encoder, "cpu-used", std::to_string(std::clamp(9 - options.effort, 0, 8)));
    set(encoder, "row-mt", "0");
    // Without lookahead, libaom encodes all frames with much the same quality, regardless of crf.
    set(encoder, "lag-in-frames", "19");
    // Disable temporal smoothing of the pictures before encoding: no quality setting would undo it.
    set(encoder, "arnr-strength", "0");
    // With `key`, the first packet depends on the first picture alone, and not on what follows it.
    set(encoder, "aom-params",
        options.key == kNoKey ? "enable-keyframe-filtering=0"
                              : "enable-keyframe-filtering=0:enable-tpl-model=0");
    // libaom codes the first picture and others that many depend on up to 30 steps better than
    // asked for. Where the worst picture counts and not the mean, that is 4 to 9 % of the bytes too
    // much.
    if (options.spread < kMaxSpread) encoder.qmin = std::max(options.crf - options.spread, 0);
    if (options.key != kNoKey) encoder.qmin = options.key;
    return;
  }
  set(encoder, "preset", kPresets[static_cast<size_t>(options.effort)]);
  // cutree writes beyond its buffers if the width of a picture is not a multiple of the vector
  // size.
  if (kind.name == "h265")
    set(encoder, "x265-params",
        "log-level=none:pools=none:frame-threads=1:wpp=0:info=0:keyint=" +
            std::to_string(kMaxGroup) + ":min-keyint=" + std::to_string(kMaxGroup) +
            ":scenecut=0:range=full:cutree=0");
}

Result<libav::Owned<AVCodecContext>> open_encoder(const VideoKind& kind,
                                                  const VideoOptions& options, PictureLayout layout,
                                                  const idf::Shape& shape) {
  libav::keep_quiet();
  const AVCodec* codec = avcodec_find_encoder_by_name(kind.encoder);
  if (codec == nullptr)
    return failed_precondition("{}: libavcodec has no encoder '{}'", kind.name, kind.encoder);
  libav::Owned<AVCodecContext> encoder(avcodec_alloc_context3(codec));
  if (!encoder) return resource_exhausted("{}: no memory for an encoder", kind.name);
  encoder->height = static_cast<int>(shape[0]);
  encoder->width = static_cast<int>(shape[1]);
  encoder->pix_fmt = pixel_format(layout);
  encoder->time_base = {1, 30};
  encoder->framerate = {30, 1};
  encoder->gop_size = kMaxGroup;
  encoder->thread_count = 1;
  encoder->color_range = AVCOL_RANGE_JPEG;
  if (shallow(layout) == PictureLayout::kYcc444) encoder->colorspace = AVCOL_SPC_SMPTE170M;
  configure(kind, options, *encoder);
  if (const int code = avcodec_open2(encoder.get(), codec, nullptr); code < 0)
    return invalid_argument("{}: the encoder refuses pictures of {} x {}: {}", kind.name, shape[1],
                            shape[0], libav::describe(code));
  return encoder;
}

Result<libav::Owned<AVCodecContext>> open_decoder(const VideoKind& kind, const VideoGroup& group) {
  libav::keep_quiet();
  const AVCodec* codec = avcodec_find_decoder_by_name(kind.decoder);
  if (codec == nullptr)
    return failed_precondition("{}: libavcodec has no decoder '{}'", kind.name, kind.decoder);
  libav::Owned<AVCodecContext> decoder(avcodec_alloc_context3(codec));
  if (!decoder) return resource_exhausted("{}: no memory for a decoder", kind.name);
  decoder->height = static_cast<int>(group.height);
  decoder->width = static_cast<int>(group.width);
  decoder->thread_count = 1;
  decoder->max_pixels = (group.height + kMaxPadding) * (group.width + kMaxPadding);
  // By default decoders conceal damage and return a plausible picture; here damage must be an
  // error.
  decoder->err_recognition = AV_EF_CRCCHECK | AV_EF_BITSTREAM | AV_EF_BUFFER | AV_EF_EXPLODE;
  if (!group.setup.empty()) {
    decoder->extradata =
        static_cast<uint8_t*>(av_mallocz(group.setup.size() + AV_INPUT_BUFFER_PADDING_SIZE));
    if (decoder->extradata == nullptr)
      return resource_exhausted("{}: no memory for a decoder", kind.name);
    std::memcpy(decoder->extradata, group.setup.data(), group.setup.size());
    decoder->extradata_size = static_cast<int>(group.setup.size());
  }
  if (const int code = avcodec_open2(decoder.get(), codec, nullptr); code < 0)
    return data_loss("{}: cannot start decoding: {}", kind.name, libav::describe(code));
  return decoder;
}

class VideoCodec final : public GroupCodec {
 public:
  VideoCodec(const VideoKind& kind, const VideoOptions& options) : kind_(kind), options_(options) {}

  [[nodiscard]] std::string_view name() const override { return kind_.name; }
  [[nodiscard]] bool is_lossless() const override { return kind_.is_lossless; }
  [[nodiscard]] double psnr_db() const override {
    if (kind_.is_lossless) return std::numeric_limits<double>::infinity();
    return options_.crf <= kind_.crf ? 32 : 15;
  }
  [[nodiscard]] size_t group_size() const override { return static_cast<size_t>(options_.group); }

  [[nodiscard]] bool accepts(idf::ElementType type, const idf::Shape& shape) const override {
    const auto layout = layout_of(type, shape, kind_.is_lossless);
    if (!layout || (*layout == PictureLayout::kGray16 && !kind_.is_lossless)) return false;
    for (const int64_t side : {shape[0], shape[1]})
      if (side < kind_.min_side || side > kMaxVideoSide) return false;
    return shape[0] * shape[1] <= kMaxPixels;
  }

  Result<std::vector<std::byte>> encode(std::span<const idf::NdArray> arrays) const override {
    ENGRAM_RETURN_IF_ERROR(check(arrays));
    const idf::NdArray& first = arrays[0];
    PictureLayout layout = *layout_of(first.type(), first.shape(), kind_.is_lossless);
    if (options_.depth > 8) layout = deep(layout);
    ENGRAM_ASSIGN_OR_RETURN(const auto encoder,
                            open_encoder(kind_, options_, layout, first.shape()));
    auto group = encode_group(*encoder, layout, arrays);
    if (!group.ok()) return group.status().with_context(kind_.name);
    return group->to_bytes();
  }

  Result<std::vector<idf::NdArray>> decode_first(std::span<const std::byte> bytes,
                                                 idf::ElementType type, const idf::Shape& shape,
                                                 size_t count, size_t wanted) const override {
    ENGRAM_CHECK(wanted <= count, "{} of {} pictures", wanted, count);
    auto arrays = decode_checked(bytes, type, shape, count, wanted);
    if (arrays.ok()) return arrays;
    return arrays.status().with_context(kind_.name);
  }

 private:
  [[nodiscard]] Status check(std::span<const idf::NdArray> arrays) const {
    if (arrays.empty() || arrays.size() > kMaxGroup)
      return invalid_argument("{}: group of {} arrays, needs 1 to {}", kind_.name, arrays.size(),
                              kMaxGroup);
    const idf::NdArray& first = arrays[0];
    if (!accepts(first.type(), first.shape()))
      return invalid_argument(
          "{}: needs uint8 [H, W, 3] or [H, W, 1]{}, sides of {} to {}, found {} {}", kind_.name,
          kind_.is_lossless ? ", uint16 [H, W, 1]" : "", kind_.min_side, kMaxVideoSide,
          to_string(first.type()), idf::to_string(first.shape()));
    for (const idf::NdArray& array : arrays)
      if (array.type() != first.type() || array.shape() != first.shape())
        return invalid_argument("{}: group of {} {} has a {} {}", kind_.name,
                                to_string(first.type()), idf::to_string(first.shape()),
                                to_string(array.type()), idf::to_string(array.shape()));
    return {};
  }

  [[nodiscard]] Result<std::vector<idf::NdArray>> decode_checked(std::span<const std::byte> bytes,
                                                                 idf::ElementType type,
                                                                 const idf::Shape& shape,
                                                                 size_t count,
                                                                 size_t wanted) const {
    ENGRAM_ASSIGN_OR_RETURN(const VideoGroup group, VideoGroup::from_bytes(bytes));
    if (!accepts(type, shape) ||
        layout_of(type, shape, kind_.is_lossless) != shallow(group.layout) ||
        group.height != shape[0] || group.width != shape[1] || group.count != count ||
        count > kMaxGroup || group.packets.size() > kMaxGroup ||
        group.setup.size() > kMaxSetupBytes)
      return data_loss("group of {} pictures {} x {}, needs {} of {} {}", group.count, group.width,
                       group.height, count, to_string(type), idf::to_string(shape));
    ENGRAM_ASSIGN_OR_RETURN(const auto decoder, open_decoder(kind_, group));
    return decode_group(*decoder, group, type, shape, wanted);
  }

  const VideoKind& kind_;
  VideoOptions options_;
};

/// Encodes one image as a group of one.
class Ffv1ImageCodec final : public Codec {
 public:
  [[nodiscard]] std::string_view name() const override { return "ffv1"; }
  [[nodiscard]] bool is_lossless() const override { return true; }
  [[nodiscard]] bool accepts(idf::ElementType type, const idf::Shape& shape) const override {
    return group_.accepts(type, shape);
  }
  Result<std::vector<std::byte>> encode(const idf::NdArray& array) const override {
    return group_.encode({&array, 1});
  }
  Result<idf::NdArray> decode(std::span<const std::byte> bytes, idf::ElementType type,
                              const idf::Shape& shape) const override {
    ENGRAM_ASSIGN_OR_RETURN(const auto arrays, group_.decode(bytes, type, shape, 1));
    return arrays[0];
  }

 private:
  VideoCodec group_{kKinds[0], {}};
};

}  // namespace

std::span<const VideoKind> video_kinds() {
  return kKinds;
}

bool is_installed(const VideoKind& kind) {
  return avcodec_find_encoder_by_name(kind.encoder) != nullptr;
}

Result<std::unique_ptr<const GroupCodec>> make_video_codec(const VideoKind& kind, CodecText text) {
  VideoOptions options;
  if (!kind.is_lossless) {
    ENGRAM_ASSIGN_OR_RETURN(options.crf, text.take("crf", true, kind.crf, 0, kind.max_crf));
    ENGRAM_ASSIGN_OR_RETURN(options.effort,
                            text.take("effort", false, kind.effort, 0, kind.max_effort));
  }
  if (kind.name == "av1") {
    ENGRAM_ASSIGN_OR_RETURN(options.depth, text.take("depth", false, 8, 8, 10));
    if (options.depth == 9) return invalid_argument("{}: depth 9, needs 8 or 10", kind.name);
    ENGRAM_ASSIGN_OR_RETURN(options.spread, text.take("spread", false, kMaxSpread, 0, kMaxSpread));
    ENGRAM_ASSIGN_OR_RETURN(options.key, text.take("key", false, kNoKey, 0, kind.max_crf));
    if (options.key > options.crf)
      return invalid_argument("{}: key {}, needs at most the crf, {}", kind.name, options.key,
                              options.crf);
  }
  ENGRAM_ASSIGN_OR_RETURN(options.group, text.take("group", false, kind.group, 1, kMaxGroup));
  ENGRAM_RETURN_IF_ERROR(text.finish());
  return std::unique_ptr<const GroupCodec>(std::make_unique<VideoCodec>(kind, options));
}

Result<std::unique_ptr<const Codec>> make_ffv1_image_codec(CodecText text) {
  ENGRAM_RETURN_IF_ERROR(text.finish());
  return std::unique_ptr<const Codec>(std::make_unique<Ffv1ImageCodec>());
}

}  // namespace engram::ltm
