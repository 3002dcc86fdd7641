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

/// How the images of one member are kept in a block. The values are part of the format.
enum class ImageForm : uint8_t { kLatents = 0, kH264 = 1, kH265 = 2, kAv1 = 3, kFfv1 = 4 };

/// The group codec of a form (ltm/codec/group_codec.h); empty for latents.
[[nodiscard]] std::string_view codec_name(ImageForm form);

/// The form of a group codec's data; nothing where blocks do not take it.
[[nodiscard]] std::optional<ImageForm> form_of_codec(std::string_view name);

/// Type and shape of an image member.
struct FrameShape {
  idf::ElementType type = idf::ElementType::kUInt8;
  idf::Shape shape;

  [[nodiscard]] PixelShape pixels() const {
    return {static_cast<int>(shape[0]), static_cast<int>(shape[1]), static_cast<int>(shape[2])};
  }
};

/// A background that a block carries itself, as the single image of a video: of a view that its
/// model was not trained on.
struct CodedBackground {
  ImageForm form = ImageForm::kAv1;
  std::vector<std::byte> bytes;
  idf::NdArray pixels;  ///< As decoded.

  friend bool operator==(const CodedBackground&, const CodedBackground&) = default;
};

/// Qualities that backgrounds are coded in, the best one first.
inline constexpr size_t kBackgroundQualities = 5;

/// Nothing where no installed video codec with loss takes such an image.
/// Errors: those of the codec.
Result<std::optional<CodedBackground>> code_background(const idf::NdArray& image, size_t quality);

/// Safe on hostile bytes. Errors: kDataLoss; kFailedPrecondition where the decoder is not
/// installed.
Result<CodedBackground> decode_background(ImageForm form, std::vector<std::byte> bytes,
                                          const FrameShape& frame);

}  // namespace engram::encoders
