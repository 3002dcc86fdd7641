// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "ltm/filter/measure.h"

namespace engram::ltm {

/// An image that is area-averaged to at most 64 pixels on its longer side, so that it is cheap to
/// keep and to compare.
///
/// Threading: immutable, const-parallel.
class ReducedImage {
 public:
  static constexpr int kLongestSide = 64;

  /// Reduces an image: an array [H, W] or [H, W, C] with C up to 4, not empty, of uint8, uint16,
  /// int16, float32 or float64. Returns nothing for other arrays. Values that are not finite count
  /// as 0.
  /// Complexity: O(number of pixels).
  static std::optional<ReducedImage> of(const idf::NdArray& array);

  /// Compares by kMse, kMae or kSsim (checked). Both must have the same size and channels
  /// (checked).
  [[nodiscard]] double measured(Measure measure, const ReducedImage& other) const;

 private:
  [[nodiscard]] double ssim(const ReducedImage& other) const;
  [[nodiscard]] double ssim_of_window(const ReducedImage& other, int top, int left, int channel,
                                      double range) const;

  int height_ = 0;
  int width_ = 0;
  int channels_ = 0;
  /// Range of the values of the element type; for floats the range of this image.
  double range_ = 0;
  std::vector<float> pixels_;  ///< [height, width, channels]
};

}  // namespace engram::ltm
