// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>

#include "ltm/core/status.h"

namespace engram::encoders {

/// Mean squared error of a black image and a white one, 0 dB. No bound of images is above it,
/// because no image errs more. Unit: squared grey levels.
inline constexpr double kMaxImageMse = 255.0 * 255.0;

/// The error of predictions of one kind and horizon as a function of the change just before them:
///
///     scale = (change + min_change) ^ exponent
///
/// Calm moments therefore get small error estimates and busy moments large ones. Changes and errors
/// are mean squares, of grey levels or in the units of the numbers.
///
/// Threading: immutable but for assignment.
/// Source: docs/learning_methods.md, section "How wrong predictions are".
struct ErrorCalibration {
  double min_change = 1;  ///< More than 0, because noise alone causes such a change.
  double exponent = 0;    ///< 0 to 1; with 0, errors do not depend on the change.
  /// Mean error, and the bound that the error keeps with kBoundProbability, both per scale. NaN if
  /// there were too few measurements.
  double expected_per_scale = std::numeric_limits<double>::quiet_NaN();
  double bound_per_scale = std::numeric_limits<double>::quiet_NaN();
  /// Mean error of all measured predictions.
  double mean = std::numeric_limits<double>::quiet_NaN();
  int64_t measured = 0;  ///< Predictions.

  [[nodiscard]] double scale(double change) const;
  /// If `change` is NaN, which means that it is not known, the result is the mean error.
  [[nodiscard]] double expected(double change) const;
  /// NaN if the bound is not known.
  [[nodiscard]] double bound(double change) const;

  /// Errors: kDataLoss if a number is out of range.
  [[nodiscard]] Status validate() const;
};

}  // namespace engram::encoders
