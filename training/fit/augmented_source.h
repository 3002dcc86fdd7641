// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <stop_token>

#include "ltm/memory/memory_id.h"
#include "training/fit/training_source.h"

// Internal to the learning rooms.

namespace engram::training {

/// The augmented instances of a store that were made of what `source` trains on: what was made of
/// anything else, such as a recording that is left out of training, would tell what is measured.
/// Runs end where the recipe changes, where one is missing, and where a recording ends. `source`
/// has its layout; values of another one are left out, too. Nothing where the store does not know
/// the entity. Errors: kInvalidArgument where the store has real snapshots of it; kCancelled; those
/// of the store.
Result<AugmentedValues> find_augmented(const std::filesystem::path& store,
                                       const ltm::MemoryId& entity, const TrainingSource& source,
                                       const std::stop_token& stop);

}  // namespace engram::training
