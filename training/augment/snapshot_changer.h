// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <filesystem>
#include <stop_token>

#include "augmentation/recipe.h"
#include "datasets/recordings/snapshot_cursor.h"
#include "ltm/core/progress.h"
#include "ltm/memory/snapshot.h"
#include "ltm/recording/recorder.h"
#include "ltm/store/store_reader.h"
#include "training/augment/augmented_store.h"

namespace engram::training {

/// Makes augmented snapshots from recorded ones.
class SnapshotChanger {
 public:
  virtual ~SnapshotChanger() = default;

  /// Returns why an entity is skipped, or an empty text. It is called before the entity's first
  /// snapshot.
  virtual std::string begin(const ltm::MemoryId& entity) = 0;

  /// Adds the changed instances of a snapshot, of those that the step asks for, to `update`. If
  /// there are none, it counts the reason in `report`.
  virtual Status change(const datasets::SnapshotCursor::Step& step, ltm::EntityUpdate& update,
                        AugmentedEntity& report) = 0;
};

/// Walks over the entities of one store and writes the other. If it is stopped, the new store is
/// valid and has the snapshots made so far.
/// Errors: kAlreadyExists if `to` exists; the errors of the changer and of the stores.
Result<AugmentReport> make_augmented_store(ltm::StoreReader& from, const std::filesystem::path& to,
                                           const std::vector<ltm::MemoryId>& entities,
                                           const AugmentedStoreOptions& options,
                                           SnapshotChanger& changer, const ProgressSink& progress,
                                           const std::stop_token& stop);

/// The metadata of an instance of an augmented snapshot.
/// Errors: kInvalidArgument if the recipe has no JSON form.
Result<ltm::InstanceMetadata> augmented_metadata(const ltm::Snapshot& origin, int32_t instance,
                                                 const augmentation::Recipe& recipe);

/// The indices of the instances, out of `count`, that a step asks for.
[[nodiscard]] std::vector<int32_t> asked_instances(const datasets::SnapshotCursor::Step& step,
                                                   size_t count);

/// The purpose of a seed. Sequences of different purposes are independent.
enum class SeedPurpose : uint64_t { kRecipe = 1, kNoise = 2, kScene = 3 };
[[nodiscard]] uint64_t seed_of(uint64_t seed, SeedPurpose purpose, int copy, int64_t moment);

/// The index of the span of time of length `hold` that contains `time`.
[[nodiscard]] int64_t part_of(Time time, Duration hold);

/// The entities that a query matches.
/// Errors: kNotFound if there is none.
Result<std::vector<ltm::MemoryId>> entities_of(ltm::StoreReader& reader, const ltm::Query& query);

}  // namespace engram::training
