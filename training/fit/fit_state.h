// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "encoders/deep_model.h"
#include "ltm/idf/data.h"
#include "training/fit/fit_step.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// What one step of a fit leaves to the next, beside LibTorch's random generator.
struct FitState {
  encoders::DeepModel& model;
  torch::optim::Adam& optimiser;
  FitStep& now;
  std::vector<double*> numbers = {};  ///< Everything else that changes.
};

/// All weights, moments of the optimiser, random generator and numbers, copied.
[[nodiscard]] idf::Data kept_state(const FitState& state);

/// Puts a kept state back: the next step is bit for bit what it would have been.
/// Errors: kDataLoss where `kept` is not of a fit like this one; then nothing is changed.
Status restore_state(const idf::Data& kept, FitState& state);

/// The weights of a kept state alone. Errors: as of restore_state.
Status restore_weights(const idf::Data& kept, encoders::DeepModel& model);

}  // namespace engram::training
