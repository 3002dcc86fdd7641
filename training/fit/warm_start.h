// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "encoders/deep_model.h"
#include "training/fit/train_options.h"
#include "training/fit/training_source.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// The model that training starts from.
struct WarmStart {
  std::shared_ptr<encoders::DeepModel> model;  ///< Null if training starts anew.
  std::string note;  ///< Names the model, or says why there is none; empty without a previous one.
};

/// Reads source.previous and checks whether its networks have the sizes in `options`. A missing or
/// damaged model is no error, but reported in the note.
/// Errors: the errors of source.read.
Result<WarmStart> find_start(const TrainingSource& source, const TrainOptions& options);

/// Copies all weights that both models have. If `to` has more backgrounds, the first ones are those
/// of `from`, and other parameters of the additional ones start at the mean of the known ones.
void copy_weights(encoders::DeepModel& from, encoders::DeepModel& to);

}  // namespace engram::training
