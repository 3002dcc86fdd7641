// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "encoders/error_calibration.h"

namespace engram::training {

/// What one more score of the same kind is at most, with the probability that is asked for: of n
/// scores the ceil((n + 1) * probability)-th. It holds on average over such samples, whatever the
/// distribution, where the order of scores tells nothing. Not a number where n is too small for
/// any: for 0.9, below 9.
/// Needs a probability between 0 and 1 (checked).
/// Source: Vovk, Gammerman, Shafer, "Algorithmic Learning in a Random World", split conformal
/// prediction.
[[nodiscard]] double conformal_quantile(std::vector<double> scores, double probability);

/// One prediction whose error is known. Mean squares.
struct MeasuredPrediction {
  double change = 0;  ///< Of the last two values before it.
  double error = 0;
};

/// Chooses the exponent on one half and measures errors by it on the other one, so that the bound
/// was not fitted to what it is measured on. The exponent is the one of 0, 0.25, ... 1 with the
/// narrowest bounds, as the mean of their logarithms; 0 where there are too few to tell. Without a
/// second half the expected error is that of the first one, and no bound is known.
[[nodiscard]] encoders::ErrorCalibration calibrate(std::span<const MeasuredPrediction> choosing,
                                                   std::span<const MeasuredPrediction> calibrating,
                                                   double min_change);

/// Widens bounds, and what is expected, by how much worse the same thing that learns nothing is on
/// `all` windows than on the `held_out` ones that `by` was measured on: these may be calmer than
/// what is to come. Never narrows; does nothing where too little is known.
void widen(encoders::ErrorCalibration& by, std::span<const MeasuredPrediction> all,
           std::span<const MeasuredPrediction> held_out);

}  // namespace engram::training
