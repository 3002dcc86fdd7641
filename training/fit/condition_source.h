// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "ltm/store/store_reader.h"
#include "training/fit/training_source.h"

// Internal to the learning rooms: the recorded past of the entity that conditions predictions of
// another one.

namespace engram::training {

/// Sets the condition of `source` to the first entity with numbers and without images that a
/// snapshot of `entity` links to, if there is one. The reader must outlive `source`.
Status add_condition(ltm::StoreReader& reader, const ltm::MemoryId& entity,
                     const ltm::SnapshotEntry& snapshot, TrainingSource& source);

/// Reads the last recorded value of `condition` at or before each time. The result is empty if one
/// is missing or there is no condition.
Result<std::vector<idf::Data>> conditions_at(ltm::StoreReader& reader,
                                             const std::optional<ltm::MemoryId>& condition,
                                             std::span<const Time> times);

}  // namespace engram::training
