// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stop_token>
#include <vector>

#include "training/fit/dataset.h"
#include "training/fit/training_source.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// Reads the augmented values of `source` for `data`, which must be complete otherwise, and
/// normalises their numbers as in `data`. Each run gets a background of its own, the median of its
/// images, as a block of a recording that the model does not know. Values made of rows on which
/// predictions are measured are marked as held out. If the values take more than `memory_bytes`,
/// evenly spaced runs are used.
/// Errors: kInvalidArgument if a value has another layout; kCancelled; the errors of reading.
Result<AugmentedRows> read_augmented(const TrainingSource& source, const Dataset& data,
                                     uint64_t memory_bytes, const std::stop_token& stop);

}  // namespace engram::training
