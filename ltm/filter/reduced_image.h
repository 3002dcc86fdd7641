// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "ltm/filter/measure.h"

namespace engram::ltm {

/// An image, area-averaged to at most 64 pixels on its longer side: cheap to keep and to compare.
///
/// Threading: immutable, const-parallel.
class ReducedImage {
 public:
  static constexpr int kLongestSide = 64;

  /// Nothing where `array` is no image: [H, W] or [H, W, C] with C up to 4, not empty, of
  /// uint8, uint16, int16, float32 or float64. What is not finite counts as 0.
  /// Complexity: O(number of pixels).
  static std::optional<ReducedImage> of(const idf::NdArray& array);

  /// By kMse, kMae or kSsim (checked). Both have the same size and channels (checked).
  [[nodiscard]] double measured(Measure measure, const ReducedImage& other) const;

 private:
  [[nodiscard]] double ssim(const ReducedImage& other) const;
  [[nodiscard]] double ssim_of_window(const ReducedImage& other, int top, int left, int channel,
                                      double range) const;

  int height_ = 0;
  int width_ = 0;
  int channels_ = 0;
  /// Of the values that the element type holds; of those of this image for floats.
  double range_ = 0;
  std::vector<float> pixels_;  ///< [height, width, channels]
};

}  // namespace engram::ltm
