// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stop_token>
#include <vector>

#include "training/fit/dataset.h"
#include "training/fit/training_source.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// Reads the augmented values of `source` as a part of `data`, which is complete but for them:
/// their numbers are normalised as its are. Each run has a background of its own, the median of its
/// images, as a block of a recording has that no model knows. What was made of rows that
/// predictions are measured on is marked as held out. More than `memory_bytes`: evenly spaced runs.
/// Errors: kInvalidArgument where a value has another layout; kCancelled; those of reading.
Result<AugmentedRows> read_augmented(const TrainingSource& source, const Dataset& data,
                                     uint64_t memory_bytes, const std::stop_token& stop);

}  // namespace engram::training
