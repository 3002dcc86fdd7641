// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <limits>
#include <string>

namespace engram::ltm {

/// How one member of a value was predicted: one value may be continued by several engines.
struct MemberPrediction {
  std::string path;    ///< As idf::Layout names it; empty where the whole value is the member.
  std::string engine;  ///< "copy-last" where the member is the last known one.
  /// The mean squared error to expect, and what the real one stays within with kBoundProbability.
  /// Unit: grey levels squared of an image, else that of the numbers, squared. Not a number where
  /// nothing is promised, and for what is only ever copied (bools, times, names of numbers): that
  /// counts in no error.
  double expected_mse = std::numeric_limits<double>::quiet_NaN();
  double bound_mse = std::numeric_limits<double>::quiet_NaN();
  double copied = 0;      ///< Share of the last known value in it, 0 to 1.
  bool is_image = false;  ///< Of the kind image: the unit of the errors.
  bool is_moving =
      false;  ///< It moved when the prediction was made; errors are those of such moments.

  /// NaNs are equal.
  friend bool operator==(const MemberPrediction& a, const MemberPrediction& b) {
    const auto same = [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); };
    return a.path == b.path && a.engine == b.engine && same(a.expected_mse, b.expected_mse) &&
           same(a.bound_mse, b.bound_mse) && a.copied == b.copied && a.is_image == b.is_image &&
           a.is_moving == b.is_moving;
  }
};

}  // namespace engram::ltm
