// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>

#include "ltm/core/status.h"

namespace engram::encoders {

/// How wrong predictions of one kind and horizon are, told by how much changed just before them:
///
///     scale = (change + min_change) ^ exponent
///
/// so that calm moments are told small errors and busy ones large errors. Changes and errors are
/// mean squares, in grey levels or in the units of numbers.
///
/// Threading: immutable but for assignment.
/// Source: docs/learning_methods.md, section "How wrong predictions are".
struct ErrorCalibration {
  double min_change = 1;  ///< More than 0: noise alone changes that much.
  double exponent = 0;    ///< 0 to 1; 0: errors do not depend on what changed.
  /// Mean error, and what it stays within with kBoundProbability, per scale. Not a number where too
  /// little was measured.
  double expected_per_scale = std::numeric_limits<double>::quiet_NaN();
  double bound_per_scale = std::numeric_limits<double>::quiet_NaN();
  double mean = std::numeric_limits<double>::quiet_NaN();  ///< Error over all that was measured.
  int64_t measured = 0;                                    ///< Predictions.

  [[nodiscard]] double scale(double change) const;
  /// Not a number for `change`: it is not known. Then errors are expected to be as usual.
  [[nodiscard]] double expected(double change) const;
  /// Not a number where it is not known.
  [[nodiscard]] double bound(double change) const;

  /// Errors: kDataLoss where a number cannot be.
  [[nodiscard]] Status validate() const;
};

}  // namespace engram::encoders
