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

/// Makes augmented snapshots of recorded ones, one after the other.
class SnapshotChanger {
 public:
  virtual ~SnapshotChanger() = default;

  /// Why nothing is made of an entity; empty: it is tried. Called before its first snapshot.
  virtual std::string begin(const ltm::MemoryId& entity) = 0;

  /// Adds to `update` what is made of a snapshot, of the instances that are asked for; adds nothing
  /// where there is nothing to make, and counts why.
  virtual Status change(const datasets::SnapshotCursor::Step& step, ltm::EntityUpdate& update,
                        AugmentedEntity& report) = 0;
};

/// Walks over the entities of one store and writes the other. Where it was stopped, what is there
/// is whole. Errors: kAlreadyExists where `to` is there; those of the changer and of the stores.
Result<AugmentReport> make_augmented_store(ltm::StoreReader& from, const std::filesystem::path& to,
                                           const std::vector<ltm::MemoryId>& entities,
                                           const AugmentedStoreOptions& options,
                                           SnapshotChanger& changer, const ProgressSink& progress,
                                           const std::stop_token& stop);

/// What an instance of an augmented snapshot says of itself.
/// Errors: kInvalidArgument where the recipe has no JSON form.
Result<ltm::InstanceMetadata> augmented_metadata(const ltm::Snapshot& origin, int32_t instance,
                                                 const augmentation::Recipe& recipe);

/// Which instances of `count` a step asks for.
[[nodiscard]] std::vector<int32_t> asked_instances(const datasets::SnapshotCursor::Step& step,
                                                   size_t count);

/// A seed for each purpose: the sequences have nothing in common.
enum class SeedPurpose : uint64_t { kRecipe = 1, kNoise = 2, kScene = 3 };
[[nodiscard]] uint64_t seed_of(uint64_t seed, SeedPurpose purpose, int copy, int64_t moment);

/// The number of the part of time that shares recipes.
[[nodiscard]] int64_t part_of(Time time, Duration hold);

/// The entities that a query asks for. Errors: kNotFound where there is none.
Result<std::vector<ltm::MemoryId>> entities_of(ltm::StoreReader& reader, const ltm::Query& query);

}  // namespace engram::training
