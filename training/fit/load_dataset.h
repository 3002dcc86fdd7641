// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stop_token>

#include "training/fit/dataset.h"
#include "training/fit/train_options.h"
#include "training/fit/training_source.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// Reads what fits into options.memory_bytes. With a model of this layout to go on from, its
/// backgrounds come first, and numbers are normalised as it does where they still fit.
/// Errors: as train_model.
Result<Dataset> load_dataset(const TrainingSource& source, const TrainOptions& options,
                             const encoders::DeepModel* start, const std::stop_token& stop);

}  // namespace engram::training
