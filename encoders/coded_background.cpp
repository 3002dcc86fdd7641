// SPDX-License-Identifier: Apache-2.0
#include "encoders/coded_background.h"

#include <algorithm>
#include <array>
#include <string>

#include "ltm/codec/group_codec.h"

namespace engram::encoders {

namespace {

constexpr std::array<std::string_view, 7> kCodecNames{"", "h264", "h265", "av1", "ffv1", "", ""};

/// Codec options per quality, in the order of preference. A background need not be good: latents
/// correct its errors if that saves bytes.
constexpr std::array<std::array<std::string_view, 3>, kBackgroundQualities> kCodecs{
    {{"av1:crf=10", "h265:crf=14", "h264:crf=12"},
     {"av1:crf=18", "h265:crf=18", "h264:crf=16"},
     {"av1:crf=25", "h265:crf=22", "h264:crf=20"},
     {"av1:crf=34", "h265:crf=28", "h264:crf=26"},
     {"av1:crf=50", "h265:crf=38", "h264:crf=36"}}};

/// AV1 takes seconds for an image of 640 x 480 with the effort of small ones, and half of that for
/// 0.7 % more bytes with this one. A training codes up to 80 backgrounds.
std::string with_effort(std::string_view codec, const idf::NdArray& image) {
  constexpr int64_t kSmallPixels = 256 * 256;
  if (!codec.starts_with("av1")) return std::string(codec);
  const int64_t pixels = image.shape()[0] * image.shape()[1];
  return std::string(codec) + (pixels <= kSmallPixels ? ",effort=7" : ",effort=5");
}

}  // namespace

std::string_view codec_name(ImageForm form) {
  return kCodecNames[static_cast<size_t>(form)];
}

std::optional<ImageForm> form_of_codec(std::string_view name) {
  const auto found = std::ranges::find(kCodecNames, name);
  if (name.empty() || found == kCodecNames.end()) return std::nullopt;
  return static_cast<ImageForm>(found - kCodecNames.begin());
}

Result<std::optional<CodedBackground>> code_background(const idf::NdArray& image, size_t quality) {
  for (const std::string_view text : kCodecs[quality]) {
    const auto codec = ltm::make_group_codec(with_effort(text, image));
    if (!codec.ok() || !(*codec)->accepts(image.type(), image.shape())) continue;
    CodedBackground background;
    background.form = *form_of_codec((*codec)->name());
    ENGRAM_ASSIGN_OR_RETURN(background.bytes, (*codec)->encode({&image, 1}));
    ENGRAM_ASSIGN_OR_RETURN(const auto decoded,
                            (*codec)->decode(background.bytes, image.type(), image.shape(), 1));
    background.pixels = decoded.front();
    return std::optional(std::move(background));
  }
  return std::optional<CodedBackground>();
}

Result<CodedBackground> decode_background(ImageForm form, std::vector<std::byte> bytes,
                                          const FrameShape& frame) {
  const ltm::GroupCodec* codec = ltm::find_group_codec(codec_name(form));
  if (codec == nullptr)
    return data_loss("background of a block: found form {}, needs a video codec",
                     static_cast<int>(form));
  ENGRAM_ASSIGN_OR_RETURN(auto decoded, codec->decode(bytes, frame.type, frame.shape, 1));
  return CodedBackground{form, std::move(bytes), std::move(decoded.front())};
}

}  // namespace engram::encoders
