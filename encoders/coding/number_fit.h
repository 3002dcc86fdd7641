// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the parts of training that fit.

#include <span>
#include <vector>

#include "encoders/coding/number_row_coder.h"
#include "encoders/coding/number_training.h"

namespace engram::encoders {

/// One recording as the channels see it. Unit: steps. Shape: [rows][C].
struct ChannelRows {
  std::vector<std::vector<double>> coded;  ///< As it will be decoded.
  std::vector<std::vector<double>> real;   ///< As it was; as `coded` where that is unknown.
};

/// The terms that predict `channel` best.
[[nodiscard]] std::vector<PredictorTerm> fit_terms(const NumberModel& model, size_t channel,
                                                   std::span<const ChannelRows> recordings,
                                                   const NumberTraining& options);

/// How the size of the next residual follows from those before: fills scale_weights and
/// scale_bias.
void fit_scales(std::span<const ResidualTrace> trace, NumberModel& model);

}  // namespace engram::encoders
