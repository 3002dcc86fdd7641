// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <limits>

namespace engram {

/// Stands for a number that nobody knows, such as the error of nothing.
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Returns the number, or NaN for an infinite one.
[[nodiscard]] inline double finite_or_nan(double number) {
  return std::isfinite(number) ? number : kNaN;
}

}  // namespace engram
