// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the parts of training that fit parameters.

#include <span>
#include <vector>

#include "encoders/coding/number_row_coder.h"
#include "encoders/coding/number_training.h"

namespace engram::encoders {

/// The channels of one recording. Unit: steps. Shape: [rows][C].
struct ChannelRows {
  std::vector<std::vector<double>> coded;  ///< Values as they will be decoded.
  /// Recorded values; those of `coded` if they are unknown.
  std::vector<std::vector<double>> real;
};

/// Chooses the terms that predict `channel` best and fits their weights.
[[nodiscard]] std::vector<PredictorTerm> fit_terms(const NumberModel& model, size_t channel,
                                                   std::span<const ChannelRows> recordings,
                                                   const NumberTraining& options);

/// Fits the expected size of the next residual as a function of those before it: fills
/// scale_weights and scale_bias.
void fit_scales(std::span<const ResidualTrace> trace, NumberModel& model);

}  // namespace engram::encoders
