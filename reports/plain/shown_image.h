// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "ltm/idf/ndarray.h"

namespace engram::reports {

/// An image that a browser shows, uint8 [H, W, 1 or 3], and what its grey levels mean.
struct ShownImage {
  idf::NdArray pixels;
  /// Values of black and white, where a depth image was scaled to grey.
  std::optional<std::pair<double, double>> range{};
  /// A grey level is so many times the error, in an error map.
  double gain = 1;
};

/// Depth and images of 16 bits are scaled: their smallest and largest finite values become black
/// and white. Other images stay as they are.
/// Shape: an image as image_at() finds it.
[[nodiscard]] ShownImage shown_image(const idf::NdArray& image);

/// A map of |recorded - other|, brightened so that the largest error is white, at most 16 times.
/// Errors: kInvalidArgument if types or shapes differ, or the images are not of 8 bits.
Result<ShownImage> error_map(const idf::NdArray& recorded, const idf::NdArray& other);

/// Encodes pixels as "jpeg" of a quality from 1 to 100, or as "png".
Result<std::string> encoded_image(const idf::NdArray& pixels, const std::string& as, int quality);

}  // namespace engram::reports
