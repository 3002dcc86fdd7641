// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "ltm/core/status.h"
#include "ltm/idf/ndarray.h"

namespace engram::training {

/// Estimates the noise of a camera from pairs of consecutive images, as the smaller of two robust
/// estimates. Diagonal differences of neighbours are not affected by smooth shading, but by
/// texture; differences in time are not affected by texture, but by motion. Images that a codec has
/// smoothed give a low estimate in both.
///
/// Threading: one thread.
/// Source: docs/learning_methods.md, section "The bound".
class NoiseFloor {
 public:
  /// Adds a pair of consecutive images. Images that are not 8-bit are ignored.
  /// Shape: both [H, W, C], with the same size.
  /// Errors: kInvalidArgument if types or shapes differ.
  Status add(const idf::NdArray& image, const idf::NdArray& next);

  /// Number of added pairs.
  [[nodiscard]] int64_t images() const { return static_cast<int64_t>(deviations_.size()); }

  /// Standard deviation of the noise: the median over all pairs, or nothing without pairs. Unit:
  /// grey levels.
  [[nodiscard]] std::optional<double> deviation() const;

 private:
  std::vector<double> deviations_;
};

/// Min and max bound that follows from noise. Unit: dB.
inline constexpr double kMinNoiseBoundDb = 30;
inline constexpr double kMaxNoiseBoundDb = 40;

/// Returns the PSNR of noise, clamped to these limits. A higher bound would spend bytes on noise.
/// `deviation` must not be negative. Unit: grey levels.
[[nodiscard]] double bound_of_noise(double deviation);

}  // namespace engram::training
