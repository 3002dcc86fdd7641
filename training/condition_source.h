// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "ltm/store/store_reader.h"
#include "training/trainer.h"

// Private to this room.

namespace engram::training {

/// The recorded past of an entity that predictions of another one start from.
class ConditionSource {
 public:
  /// The first entity of numbers, without images, that a snapshot of `entity` links to.
  static Result<std::optional<ltm::MemoryId>> find(ltm::StoreReader& reader,
                                                   const ltm::MemoryId& entity,
                                                   const ltm::SnapshotEntry& snapshot);

  /// Tells a source what to start from, where there is something. The reader outlives it.
  static Status add(ltm::StoreReader& reader, const ltm::MemoryId& entity,
                    const ltm::SnapshotEntry& snapshot, TrainingSource& source);

  /// The last recorded value at or before a time; nothing where there is none.
  static Result<std::optional<idf::Data>> at(ltm::StoreReader& reader,
                                             const ltm::MemoryId& condition, Time time);

  /// One for each time; none at all where one is missing.
  static Result<std::vector<idf::Data>> at_all(ltm::StoreReader& reader,
                                               const std::optional<ltm::MemoryId>& condition,
                                               std::span<const Time> times);
};

}  // namespace engram::training
