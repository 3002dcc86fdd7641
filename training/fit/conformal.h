// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "encoders/error_calibration.h"

namespace engram::training {

/// The bound that one more score of the same kind keeps with `probability`: of n scores the ceil((n
/// + 1) * probability)-th. This holds on average over such samples for any distribution, if the
/// scores are exchangeable. The result is NaN if n is too small for a bound, which for 0.9 is below
/// 9. `probability` must be between 0 and 1 (checked).
/// Source: Vovk, Gammerman, Shafer, "Algorithmic Learning in a Random World", split conformal
/// prediction.
[[nodiscard]] double conformal_quantile(std::vector<double> scores, double probability);

/// A prediction whose error is known. Both members are mean squares.
struct MeasuredPrediction {
  double change = 0;  ///< Difference of the last two values before it.
  double error = 0;
};

/// Chooses the exponent on `choosing` and measures errors on `calibrating`, so that the bound is
/// not fitted to its own measurements. The exponent is the one of 0, 0.25, ... 1 with the narrowest
/// bounds by the mean of their logarithms, or 0 if there are too few predictions. If `calibrating`
/// is empty, the expected error is that of `choosing`, and there is no bound.
[[nodiscard]] encoders::ErrorCalibration calibrate(std::span<const MeasuredPrediction> choosing,
                                                   std::span<const MeasuredPrediction> calibrating,
                                                   double min_change);

/// Widens bounds and expected errors by the ratio of the errors of copies on `all` windows to those
/// on the `held_out` windows on which `by` was measured, because these may be calmer than the
/// future. It never narrows, and does nothing if too little is known.
void widen(encoders::ErrorCalibration& by, std::span<const MeasuredPrediction> all,
           std::span<const MeasuredPrediction> held_out);

}  // namespace engram::training
