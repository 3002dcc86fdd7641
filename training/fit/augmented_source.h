// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <stop_token>

#include "ltm/memory/memory_id.h"
#include "training/fit/training_source.h"

// Internal to the learning rooms.

namespace engram::training {

/// Finds the augmented instances of a store that were made of snapshots of `source`. All others are
/// left out: they may be made of recordings that are held out, on which models are measured. A run
/// ends if the recipe changes, an instance is missing, or the recording ends. `source` must have
/// its layout; values of another one are left out. The result is empty if the store does not know
/// the entity.
/// Errors: kInvalidArgument if the store has real snapshots of the entity; kCancelled; the errors
/// of the store.
Result<AugmentedValues> find_augmented(const std::filesystem::path& store,
                                       const ltm::MemoryId& entity, const TrainingSource& source,
                                       const std::stop_token& stop);

}  // namespace engram::training
