// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: arrays as pictures of libavcodec.

#include <optional>

#include "ltm/codec/libav.h"
#include "ltm/idf/ndarray.h"

namespace engram::ltm {

/// The layout of an array's numbers in a picture. The values are part of the format: never
/// renumber.
enum class PictureLayout : uint8_t {
  kGray8 = 0,
  kGray16 = 1,
  /// Unchanged red, green and blue, in four bytes per pixel.
  kRgb = 2,
  /// Luma and two colour differences at full resolution (BT.601, full range). Rounding changes a
  /// number by at most 2 when it is converted back to RGB.
  kYcc444 = 3,
  /// The same two layouts in ten bits. A codec that computes with ten bits rounds less between its
  /// pictures, so it takes fewer bytes for the same error, although the arrays have eight bits.
  kYcc444Deep = 4,
  kGray8Deep = 5,
};

/// The layout of an array, or nullopt if the array is not a picture: uint8 [H, W, 3] or [H, W, 1],
/// uint16 [H, W, 1].
[[nodiscard]] std::optional<PictureLayout> layout_of(idf::ElementType type, const idf::Shape& shape,
                                                     bool keeps_rgb);

/// The layout of ten bits for one of eight, or the layout itself if there is none.
[[nodiscard]] PictureLayout deep(PictureLayout layout);

/// Undoes deep().
[[nodiscard]] PictureLayout shallow(PictureLayout layout);

[[nodiscard]] AVPixelFormat pixel_format(PictureLayout layout);

/// Allocates a picture for arrays of this layout and shape.
/// Errors: kResourceExhausted.
Result<libav::Owned<AVFrame>> make_picture(PictureLayout layout, const idf::Shape& shape);

/// Copies an array into the picture. It must have the picture's size.
void write_picture(const idf::NdArray& array, PictureLayout layout, AVFrame& picture);

/// Copies a decoded picture into an array. Errors: kDataLoss if the picture has another size or
/// pixel format.
Result<idf::NdArray> read_picture(const AVFrame& picture, PictureLayout layout,
                                  idf::ElementType type, const idf::Shape& shape);

}  // namespace engram::ltm
