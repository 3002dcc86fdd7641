// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "encoders/deep_model.h"
#include "ltm/idf/data.h"
#include "training/fit/fit_step.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// The state that one step of a fit leaves to the next, besides LibTorch's random generator.
struct FitState {
  encoders::DeepModel& model;
  torch::optim::Adam& optimiser;
  FitStep& now;
  std::vector<double*> numbers = {};  ///< All other numbers that change.
};

/// Copies all weights, the moments of the optimiser, the random generator and the numbers.
[[nodiscard]] idf::Data kept_state(const FitState& state);

/// Restores a kept state. The next step is then bit for bit the same as without the interruption.
/// Errors: kDataLoss if `kept` is of a different fit; then nothing is changed.
Status restore_state(const idf::Data& kept, FitState& state);

/// Restores only the weights of a kept state.
/// Errors: as for restore_state.
Status restore_weights(const idf::Data& kept, encoders::DeepModel& model);

}  // namespace engram::training
