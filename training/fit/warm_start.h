// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "encoders/deep_model.h"
#include "training/fit/train_options.h"
#include "training/fit/training_source.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// Where training starts from.
struct WarmStart {
  std::shared_ptr<encoders::DeepModel> model;  ///< Null: it starts anew.
  std::string note;  ///< Which model it is, or why it is none; empty without a previous one.
};

/// Reads source.previous, and sees whether its networks have the sizes that `options` ask for.
/// What is missing or damaged only is told in the note.
/// Errors: those of source.read.
Result<WarmStart> find_start(const TrainingSource& source, const TrainOptions& options);

/// Copies all weights that both models have. Of a model with more backgrounds the first ones are
/// those of `from`; what else belongs to the others starts at the mean of those.
void copy_weights(encoders::DeepModel& from, encoders::DeepModel& to);

}  // namespace engram::training
