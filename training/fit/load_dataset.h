// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stop_token>

#include "training/fit/dataset.h"
#include "training/fit/train_options.h"
#include "training/fit/training_source.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// Reads the values that fit into options.memory_bytes. If training starts from a model of this
/// layout, its backgrounds come first, and numbers are normalised as in that model unless they have
/// moved too far.
/// Errors: as for train_model.
Result<Dataset> load_dataset(const TrainingSource& source, const TrainOptions& options,
                             const encoders::DeepModel* start, const std::stop_token& stop);

/// Reads consecutive rows of the source as the dataset holds them.
/// Errors: those of the source; kInvalidArgument for a value of another layout.
Result<DatasetRows> read_rows(const TrainingSource& source, const Dataset& data,
                              const Sequence& run);

}  // namespace engram::training
