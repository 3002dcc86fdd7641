// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "ltm/core/status.h"

namespace engram::training {

/// A point of a rate-distortion curve.
struct RatePoint {
  double bytes = 0;  ///< Per frame, or per any unit that both curves share.
  double psnr_db = 0;
};

/// Bits per pixel of a colour or grey image.
[[nodiscard]] inline double bits_per_pixel(double bytes, double height, double width) {
  return 8 * bytes / (height * width);
}

/// The Bjontegaard delta rate: the mean relative difference in bytes of `curve` to `reference` at
/// equal quality, over the range of quality that both share. -0.2 is a fifth fewer bytes.
/// Logarithms of bytes over quality are interpolated by monotone piecewise cubics and integrated.
/// Errors: kInvalidArgument if a curve has fewer than two points, equal qualities or bytes that are
/// not positive, or if the curves share no range of quality.
/// Source: Bjontegaard, VCEG-M33, 2001; piecewise cubic as in Fritsch and Butland, 1984.
Result<double> bd_rate(std::span<const RatePoint> reference, std::span<const RatePoint> curve);

}  // namespace engram::training
