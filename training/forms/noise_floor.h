// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "ltm/core/status.h"
#include "ltm/idf/ndarray.h"

namespace engram::training {

/// The noise of a camera, from some pairs of consecutive images: robust in both of two ways, and
/// the smaller of these. Diagonal differences of neighbours know no smooth shading, but texture;
/// differences in time know no texture, but motion. What a codec has smoothed has little of both.
///
/// Threading: one thread.
/// Source: docs/learning.md, section "The bound".
class NoiseFloor {
 public:
  /// Two consecutive images. Others than 8-bit ones are left out.
  /// Shape: both [H, W, C], alike. Errors: kInvalidArgument where they are not alike.
  Status add(const idf::NdArray& image, const idf::NdArray& next);

  /// Pairs that were added.
  [[nodiscard]] int64_t images() const { return static_cast<int64_t>(deviations_.size()); }

  /// Standard deviation, the median over all pairs; nothing without any. Unit: grey levels.
  [[nodiscard]] std::optional<double> deviation() const;

 private:
  std::vector<double> deviations_;
};

/// Where a bound that follows from noise ends. Unit: dB.
inline constexpr double kMinNoiseBoundDb = 30;
inline constexpr double kMaxNoiseBoundDb = 40;

/// The PSNR of noise, within these ends: images that are kept better keep noise.
/// `deviation`: in grey levels, not negative.
[[nodiscard]] double bound_of_noise(double deviation);

}  // namespace engram::training
