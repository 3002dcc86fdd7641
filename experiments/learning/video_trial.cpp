// SPDX-License-Identifier: Apache-2.0
#include "learning/video_trial.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavutil/log.h>
#include <libavutil/mem.h>
#include <libavutil/opt.h>
#include <libavutil/pixdesc.h>
}

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <numeric>
#include <sstream>

#include "ltm/codec/group_codec.h"
#include "store/store_measure.h"
#include "training/quality/psnr.h"

namespace engram::experiments {

namespace {

constexpr int kAlignment = 64;
constexpr int kNoKeyFrame = 1024;
/// What a group adds to its packets: once, and for each.
constexpr int kGroupBytes = 28, kPacketBytes = 8;

struct Free {
  void operator()(AVCodecContext* it) const { avcodec_free_context(&it); }
  void operator()(AVFrame* it) const { av_frame_free(&it); }
  void operator()(AVPacket* it) const { av_packet_free(&it); }
};
template <typename T>
using Owned = std::unique_ptr<T, Free>;

/// Converts between images and planes of any depth; colours may be stored at half the resolution.
class Planes {
 public:
  Planes(AVPixelFormat format, const idf::Shape& shape)
      : height_(shape[0]), width_(shape[1]), format_(format) {
    const AVPixFmtDescriptor* about = av_pix_fmt_desc_get(format);
    is_deep_ = about->comp[0].depth > 8;
    max_ = (1 << about->comp[0].depth) - 1;
    middle_ = 1 << (about->comp[0].depth - 1);
    is_rgb_ = (about->flags & AV_PIX_FMT_FLAG_RGB) != 0;
    step_ = 1 << about->log2_chroma_w;
  }

  [[nodiscard]] AVColorSpace colour_space() const {
    return is_rgb_ ? AVCOL_SPC_RGB : AVCOL_SPC_SMPTE170M;
  }

  [[nodiscard]] Owned<AVFrame> make() const {
    Owned<AVFrame> picture(av_frame_alloc());
    picture->format = format_;
    picture->height = static_cast<int>(height_);
    picture->width = static_cast<int>(width_);
    picture->color_range = AVCOL_RANGE_JPEG;
    picture->colorspace = colour_space();
    if (av_frame_get_buffer(picture.get(), kAlignment) < 0) picture.reset();
    return picture;
  }

  void write(const idf::NdArray& image, AVFrame& picture) const {
    const auto rgb = image.values<uint8_t>();
    const double scale = max_ / 255.0;
    for (int64_t y = 0; y < height_; ++y)
      for (int64_t x = 0; x < width_; ++x) {
        const uint8_t* c = &rgb[static_cast<size_t>(3 * (y * width_ + x))];
        put(picture, 0, y, x,
            scale * (is_rgb_ ? c[1] : 0.299 * c[0] + 0.587 * c[1] + 0.114 * c[2]));
      }
    for (int64_t y = 0; y < height_; y += step_)
      for (int64_t x = 0; x < width_; x += step_) write_colours(rgb, y, x, scale, picture);
  }

  [[nodiscard]] idf::NdArray read(const AVFrame& picture) const {
    std::vector<uint8_t> rgb;
    rgb.reserve(static_cast<size_t>(3 * height_ * width_));
    const double scale = 255.0 / max_;
    const auto add = [&](double value) {
      rgb.push_back(static_cast<uint8_t>(std::clamp(std::floor(value + 0.5), 0.0, 255.0)));
    };
    for (int64_t y = 0; y < height_; ++y)
      for (int64_t x = 0; x < width_; ++x) {
        const double luma = scale * get(picture, 0, y, x);
        double blue = scale * colour(picture, 1, y, x), red = scale * colour(picture, 2, y, x);
        if (!is_rgb_) {
          blue -= scale * middle_;
          red -= scale * middle_;
        }
        add(is_rgb_ ? red : luma + 1.402 * red);
        add(is_rgb_ ? luma : luma - 0.344136 * blue - 0.714136 * red);
        add(is_rgb_ ? blue : luma + 1.772 * blue);
      }
    return idf::NdArray::take<uint8_t>({height_, width_, 3}, std::move(rgb));
  }

  [[nodiscard]] bool holds(const AVFrame& picture) const {
    const AVPixFmtDescriptor* about =
        av_pix_fmt_desc_get(static_cast<AVPixelFormat>(picture.format));
    return about != nullptr && (1 << about->comp[0].depth) - 1 == max_ &&
           1 << about->log2_chroma_w == step_ && picture.height == height_ &&
           picture.width == width_;
  }

 private:
  void write_colours(std::span<const uint8_t> rgb, int64_t y, int64_t x, double scale,
                     AVFrame& picture) const {
    double blue = 0, red = 0, count = 0;
    for (int64_t j = y; j < std::min(y + step_, height_); ++j)
      for (int64_t i = x; i < std::min(x + step_, width_); ++i, ++count) {
        const uint8_t* c = &rgb[static_cast<size_t>(3 * (j * width_ + i))];
        blue += is_rgb_ ? c[2] : -0.168736 * c[0] - 0.331264 * c[1] + 0.5 * c[2];
        red += is_rgb_ ? c[0] : 0.5 * c[0] - 0.418688 * c[1] - 0.081312 * c[2];
      }
    const double zero = is_rgb_ ? 0 : middle_;
    put(picture, 1, y / step_, x / step_, zero + scale * blue / count);
    put(picture, 2, y / step_, x / step_, zero + scale * red / count);
  }

  /// Interpolates linearly where colours have half the resolution.
  [[nodiscard]] double colour(const AVFrame& picture, int plane, int64_t y, int64_t x) const {
    if (step_ == 1) return get(picture, plane, y, x);
    const int64_t y0 = y / 2, x0 = x / 2;
    const int64_t y1 = std::clamp<int64_t>(y0 + (y % 2 == 0 ? -1 : 1), 0, (height_ - 1) / 2);
    const int64_t x1 = std::clamp<int64_t>(x0 + (x % 2 == 0 ? -1 : 1), 0, (width_ - 1) / 2);
    return (9 * get(picture, plane, y0, x0) + 3 * get(picture, plane, y1, x0) +
            3 * get(picture, plane, y0, x1) + get(picture, plane, y1, x1)) /
           16;
  }

  void put(AVFrame& picture, int plane, int64_t y, int64_t x, double value) const {
    uint8_t* row = picture.data[plane] + y * picture.linesize[plane];
    const int number = std::clamp(static_cast<int>(std::floor(value + 0.5)), 0, max_);
    if (is_deep_)
      reinterpret_cast<uint16_t*>(row)[x] = static_cast<uint16_t>(number);
    else
      row[x] = static_cast<uint8_t>(number);
  }

  [[nodiscard]] double get(const AVFrame& picture, int plane, int64_t y, int64_t x) const {
    const uint8_t* row = picture.data[plane] + y * picture.linesize[plane];
    return is_deep_ ? reinterpret_cast<const uint16_t*>(row)[x] : row[x];
  }

  int64_t height_, width_;
  AVPixelFormat format_;
  bool is_deep_ = false, is_rgb_ = false;
  int max_ = 255, middle_ = 128;
  int64_t step_ = 1;
};

/// Options of an encoder, and those for the library behind it, joined by colons.
class EncoderOptions {
 public:
  EncoderOptions(const std::string& encoder, int crf) {
    own_["crf"] = std::to_string(crf);
    if (encoder == "libaom-av1") {
      own_["row-mt"] = "0";
      own_["arnr-strength"] = "0";
      behind_["aom-params"] = "enable-keyframe-filtering=0";
    } else if (encoder == "libx265") {
      behind_["x265-params"] =
          "log-level=none:pools=none:frame-threads=1:wpp=0:info=0:keyint=1024:min-keyint=1024:"
          "scenecut=0:range=full";
    }
  }

  void add(const std::string& key, const std::string& value) {
    for (const auto& [prefix, name] : kBehind)
      if (key.starts_with(prefix)) {
        std::string& all = behind_[std::string(name)];
        all += (all.empty() ? "" : ":") + key.substr(prefix.size()) + "=" + value;
        return;
      }
    own_[key] = value;
  }

  Status apply(AVCodecContext& encoder) const {
    for (const auto* options : {&own_, &behind_})
      for (const auto& [key, value] : *options)
        if (av_opt_set(encoder.priv_data, key.c_str(), value.c_str(), 0) < 0)
          return invalid_argument("the encoder refuses '{}={}'", key, value);
    return {};
  }

 private:
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 3> kBehind{
      {{"aom.", "aom-params"}, {"x265.", "x265-params"}, {"svt.", "svtav1-params"}}};

  std::map<std::string, std::string> own_, behind_;
};

using Packets = std::vector<Owned<AVPacket>>;

Status encode(AVCodecContext& encoder, const Planes& planes, std::span<const idf::NdArray> images,
              Packets& packets) {
  const auto picture = planes.make();
  if (!picture) return resource_exhausted("no memory for a picture");
  for (size_t i = 0; i <= images.size(); ++i) {
    const bool is_end = i == images.size();
    if (!is_end) {
      if (av_frame_make_writable(picture.get()) < 0)
        return resource_exhausted("no memory for a picture");
      planes.write(images[i], *picture);
      picture->pts = static_cast<int64_t>(i);
    }
    if (avcodec_send_frame(&encoder, is_end ? nullptr : picture.get()) < 0)
      return invalid_argument("the encoder refuses image {}", i);
    for (Owned<AVPacket> packet(av_packet_alloc());
         avcodec_receive_packet(&encoder, packet.get()) >= 0; packet.reset(av_packet_alloc()))
      packets.push_back(std::move(packet));
  }
  return {};
}

Result<Owned<AVCodecContext>> open_trial_decoder(AVCodecID id, const AVCodecContext& encoder) {
  // FFmpeg's own decoder of AV1 needs hardware.
  const AVCodec* codec =
      id == AV_CODEC_ID_AV1 ? avcodec_find_decoder_by_name("libdav1d") : avcodec_find_decoder(id);
  if (codec == nullptr) return failed_precondition("no decoder of {}", avcodec_get_name(id));
  Owned<AVCodecContext> decoder(avcodec_alloc_context3(codec));
  decoder->thread_count = 1;
  if (encoder.extradata_size > 0) {
    const auto size = static_cast<size_t>(encoder.extradata_size);
    decoder->extradata = static_cast<uint8_t*>(av_mallocz(size + AV_INPUT_BUFFER_PADDING_SIZE));
    std::memcpy(decoder->extradata, encoder.extradata, size);
    decoder->extradata_size = encoder.extradata_size;
  }
  if (avcodec_open2(decoder.get(), codec, nullptr) < 0)
    return failed_precondition("the decoder of {} does not open", avcodec_get_name(id));
  return decoder;
}

Result<std::vector<idf::NdArray>> decode(AVCodecContext& decoder, const Planes& planes,
                                         const Packets& packets) {
  std::vector<idf::NdArray> images;
  const Owned<AVFrame> picture(av_frame_alloc());
  for (size_t i = 0; i <= packets.size(); ++i) {
    if (avcodec_send_packet(&decoder, i < packets.size() ? packets[i].get() : nullptr) < 0)
      return data_loss("the decoder refuses packet {}", i);
    while (avcodec_receive_frame(&decoder, picture.get()) >= 0) {
      if (!planes.holds(*picture)) return data_loss("a decoded picture has another format");
      images.push_back(planes.read(*picture));
    }
  }
  return images;
}

Status add_quality(std::span<const idf::NdArray> images, std::span<const idf::NdArray> decoded,
                   TrialResult& result) {
  if (decoded.size() != images.size())
    return data_loss("{} images of {}", decoded.size(), images.size());
  for (size_t i = 0; i < images.size(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(const double mse, training::image_mse(images[i], decoded[i]));
    result.psnr_db.push_back(training::psnr_db(mse));
  }
  return {};
}

Result<TrialResult> run_group_codec(const std::string& text, std::span<const idf::NdArray> images,
                                    int crf) {
  const bool has_options = text.find(':') != std::string::npos;
  ENGRAM_ASSIGN_OR_RETURN(const auto coder, ltm::make_group_codec(fmt::format(
                                                "{}{}crf={}", text, has_options ? "," : ":", crf)));
  TrialResult result;
  const double start = cpu_seconds();
  ENGRAM_ASSIGN_OR_RETURN(const auto bytes, coder->encode(images));
  const double middle = cpu_seconds();
  ENGRAM_ASSIGN_OR_RETURN(const auto decoded,
                          coder->decode(bytes, images[0].type(), images[0].shape(), images.size()));
  result.decode_seconds = cpu_seconds() - middle;
  result.encode_seconds = middle - start;
  result.bytes = static_cast<double>(bytes.size());
  ENGRAM_RETURN_IF_ERROR(add_quality(images, decoded, result));
  return result;
}

}  // namespace

double TrialResult::min_db() const {
  return *std::ranges::min_element(psnr_db);
}

double TrialResult::mean_db() const {
  return std::accumulate(psnr_db.begin(), psnr_db.end(), 0.0) / static_cast<double>(psnr_db.size());
}

Result<VideoTrial> VideoTrial::create(const std::string& text) {
  av_log_set_level(AV_LOG_QUIET);
  VideoTrial trial;
  trial.text_ = text;
  if (text.find(' ') == std::string::npos) {
    ENGRAM_RETURN_IF_ERROR(ltm::make_group_codec(text).status());
    return trial;
  }
  std::istringstream words(text);
  words >> trial.encoder_ >> trial.format_;
  for (std::string word; words >> word;) {
    const size_t split = word.find('=');
    if (split == std::string::npos)
      return invalid_argument("trial '{}': '{}' has no value", text, word);
    trial.options_.emplace_back(word.substr(0, split), word.substr(split + 1));
  }
  if (avcodec_find_encoder_by_name(trial.encoder_.c_str()) == nullptr)
    return failed_precondition("libavcodec has no encoder '{}'", trial.encoder_);
  if (av_get_pix_fmt(trial.format_.c_str()) == AV_PIX_FMT_NONE)
    return failed_precondition("libavcodec has no format '{}'", trial.format_);
  return trial;
}

int VideoTrial::max_crf() const {
  return text_.find("av1") == std::string::npos ? 51 : 63;
}

Result<TrialResult> VideoTrial::run(std::span<const idf::NdArray> images, int crf) const {
  if (is_group_codec()) return run_group_codec(text_, images, crf);
  const AVCodec* codec = avcodec_find_encoder_by_name(encoder_.c_str());
  const Planes planes(av_get_pix_fmt(format_.c_str()), images[0].shape());
  Owned<AVCodecContext> encoder(avcodec_alloc_context3(codec));
  encoder->height = static_cast<int>(images[0].shape()[0]);
  encoder->width = static_cast<int>(images[0].shape()[1]);
  encoder->pix_fmt = av_get_pix_fmt(format_.c_str());
  encoder->time_base = {1, 30};
  encoder->framerate = {30, 1};
  encoder->gop_size = kNoKeyFrame;
  encoder->thread_count = 1;
  encoder->bit_rate = 0;
  encoder->color_range = AVCOL_RANGE_JPEG;
  encoder->colorspace = planes.colour_space();
  EncoderOptions options(encoder_, crf);
  for (const auto& [key, value] : options_)
    if (key == "qmin")
      encoder->qmin = std::clamp(crf + std::stoi(value), 0, max_crf());
    else if (key == "qmax")
      encoder->qmax = std::clamp(crf + std::stoi(value), 0, max_crf());
    else
      options.add(key, value);
  ENGRAM_RETURN_IF_ERROR(options.apply(*encoder));
  TrialResult result;
  const double start = cpu_seconds();
  if (avcodec_open2(encoder.get(), codec, nullptr) < 0)
    return invalid_argument("trial '{}': the encoder does not open", text_);
  Packets packets;
  ENGRAM_RETURN_IF_ERROR(encode(*encoder, planes, images, packets));
  result.encode_seconds = cpu_seconds() - start;
  result.bytes = kGroupBytes + encoder->extradata_size;
  for (const auto& packet : packets) result.bytes += kPacketBytes + packet->size;
  ENGRAM_ASSIGN_OR_RETURN(const auto decoder, open_trial_decoder(codec->id, *encoder));
  const double middle = cpu_seconds();
  ENGRAM_ASSIGN_OR_RETURN(const auto decoded, decode(*decoder, planes, packets));
  result.decode_seconds = cpu_seconds() - middle;
  ENGRAM_RETURN_IF_ERROR(add_quality(images, decoded, result));
  return result;
}

}  // namespace engram::experiments
