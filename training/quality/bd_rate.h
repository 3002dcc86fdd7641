// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "ltm/core/status.h"

namespace engram::training {

/// What a codec needs for what quality.
struct RatePoint {
  double bytes = 0;  ///< Per frame, or of any unit that both curves share.
  double psnr_db = 0;
};

/// Bits per pixel of a colour or grey image.
[[nodiscard]] inline double bits_per_pixel(double bytes, double height, double width) {
  return 8 * bytes / (height * width);
}

/// How many more bytes `curve` needs than `reference` on average at equal quality, where both were
/// measured: -0.2 is a fifth fewer. Logarithms of bytes over quality are interpolated by monotone
/// piecewise cubics and integrated.
/// Errors: kInvalidArgument where a curve has fewer than two points, equal qualities, bytes that
/// are not positive, or the curves share no range of quality.
/// Source: Bjontegaard, VCEG-M33, 2001; piecewise cubic as in Fritsch and Butland, 1984.
Result<double> bd_rate(std::span<const RatePoint> reference, std::span<const RatePoint> curve);

}  // namespace engram::training
