// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: arrays as pictures of libavcodec.

#include <optional>

#include "ltm/codec/libav.h"
#include "ltm/idf/ndarray.h"

namespace engram::ltm {

/// How the numbers of an array lie in a picture. The values are part of the format: never renumber.
enum class PictureLayout : uint8_t {
  kGray8 = 0,
  kGray16 = 1,
  /// Red, green and blue as they are, four bytes each.
  kRgb = 2,
  /// Luma and two colour differences at full resolution (BT.601, full range). Back to RGB, rounding
  /// alone changes a number by 2 at most.
  kYcc444 = 3,
};

/// Nothing where the array is no picture of this kind: uint8 [H, W, 3] or [H, W, 1], uint16
/// [H, W, 1].
[[nodiscard]] std::optional<PictureLayout> layout_of(idf::ElementType type, const idf::Shape& shape,
                                                     bool keeps_rgb);

[[nodiscard]] AVPixelFormat pixel_format(PictureLayout layout);

/// A picture with room for such arrays.
/// Errors: kResourceExhausted.
Result<libav::Owned<AVFrame>> make_picture(PictureLayout layout, const idf::Shape& shape);

/// Needs an array of the picture's size.
void write_picture(const idf::NdArray& array, PictureLayout layout, AVFrame& picture);

/// Errors: kDataLoss where the decoded picture has another size or pixel format.
Result<idf::NdArray> read_picture(const AVFrame& picture, PictureLayout layout,
                                  idf::ElementType type, const idf::Shape& shape);

}  // namespace engram::ltm
