// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <limits>
#include <string>

namespace engram::ltm {

/// How one member of a value was predicted. Several engines may predict members of the same value.
struct MemberPrediction {
  std::string path;    ///< The path in idf::Layout; empty where the whole value is the member.
  std::string engine;  ///< "copy-last" where the member is a copy of the last known one.
  /// The expected mean squared error, and the bound that the real error keeps with probability
  /// kBoundProbability. Unit: grey levels squared for an image, otherwise the unit of the numbers,
  /// squared. NaN where nothing is promised, and for members that do not count.
  double expected_mse = std::numeric_limits<double>::quiet_NaN();
  double bound_mse = std::numeric_limits<double>::quiet_NaN();
  double copied = 0;      ///< Share of the last known value in it, 0 to 1.
  bool is_image = false;  ///< The member is an image, which sets the unit of the errors.
  /// It moved when the prediction was made; the errors are those of such moments.
  bool is_moving = false;
  /// False for a member that is only ever copied (a bool, a time, a named number): it counts in no
  /// error.
  bool is_counted = true;

  /// NaNs are equal.
  friend bool operator==(const MemberPrediction& a, const MemberPrediction& b) {
    const auto same = [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); };
    return a.path == b.path && a.engine == b.engine && same(a.expected_mse, b.expected_mse) &&
           same(a.bound_mse, b.bound_mse) && a.copied == b.copied && a.is_image == b.is_image &&
           a.is_moving == b.is_moving && a.is_counted == b.is_counted;
  }
};

}  // namespace engram::ltm
