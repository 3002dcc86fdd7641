// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "encoders/coding/residual_image.h"
#include "ltm/core/status.h"
#include "ltm/idf/ndarray.h"

namespace engram::encoders {

/// The form in which a block keeps the images of one member. The values are part of the format.
enum class ImageForm : uint8_t {
  kLatents = 0,
  kH264 = 1,
  kH265 = 2,
  kAv1 = 3,
  kFfv1 = 4,
  kGist = 5,       ///< What remains of old images (encoders/gist_video.h); never of a background.
  kPackedAv1 = 6,  ///< AV1 in a shorter code (encoders/packed_video.h); never of a background.
};

/// The group codec of a form (ltm/codec/group_codec.h); empty for latents, gists and packed videos.
[[nodiscard]] std::string_view codec_name(ImageForm form);

/// The form for a group codec's name; empty if blocks do not accept that codec.
[[nodiscard]] std::optional<ImageForm> form_of_codec(std::string_view name);

/// Type and shape of an image member.
struct FrameShape {
  idf::ElementType type = idf::ElementType::kUInt8;
  idf::Shape shape;

  [[nodiscard]] PixelShape pixels() const {
    return {static_cast<int>(shape[0]), static_cast<int>(shape[1]), static_cast<int>(shape[2])};
  }
};

/// A background that a block carries itself, coded as a video of one image, because the model was
/// not trained on its view.
struct CodedBackground {
  ImageForm form = ImageForm::kAv1;
  std::vector<std::byte> bytes;
  idf::NdArray pixels;  ///< As decoded.

  friend bool operator==(const CodedBackground&, const CodedBackground&) = default;
};

/// Number of qualities in which a background may be coded. Quality 0 is the best one.
inline constexpr size_t kBackgroundQualities = 5;

/// Codes a background. The result is empty if no installed lossy video codec accepts such an image.
/// Errors: the codec's errors.
Result<std::optional<CodedBackground>> code_background(const idf::NdArray& image, size_t quality);

/// Decodes a background. It is safe on hostile bytes.
/// Errors: kDataLoss if the bytes are damaged; kFailedPrecondition if the decoder is not installed.
Result<CodedBackground> decode_background(ImageForm form, std::vector<std::byte> bytes,
                                          const FrameShape& frame);

}  // namespace engram::encoders
