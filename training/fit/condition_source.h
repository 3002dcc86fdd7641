// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "ltm/store/store_reader.h"
#include "training/fit/training_source.h"

// Internal to the learning rooms: the recorded past of the entity that predictions of another one
// start from.

namespace engram::training {

/// Tells `source` the first entity of numbers, without images, that a snapshot of `entity` links
/// to; nothing where there is none. The reader outlives it.
Status add_condition(ltm::StoreReader& reader, const ltm::MemoryId& entity,
                     const ltm::SnapshotEntry& snapshot, TrainingSource& source);

/// The last recorded value of `condition` at or before each time; none at all where one is missing,
/// or where there is no condition.
Result<std::vector<idf::Data>> conditions_at(ltm::StoreReader& reader,
                                             const std::optional<ltm::MemoryId>& condition,
                                             std::span<const Time> times);

}  // namespace engram::training
