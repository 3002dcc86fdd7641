// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "ltm/idf/layout.h"
#include "ltm/store/store_reader.h"
#include "training/forms/representation.h"
#include "training/night/consolidate_plan.h"
#include "training/night/entity_work.h"

// Private to this room.

namespace engram::training {

/// The first step's result: what is to be done with an entity, and with which of its snapshots.
struct PlannedEntity {
  EntityPlan plan;  ///< As it is told; its reason to be skipped ends the work.
  std::vector<ltm::SnapshotEntry> entries;  ///< Recorded, of one layout.
  idf::Layout layout;
  uint64_t left_behind = 0;  ///< Recorded snapshots of another layout.
  double plain_bytes = 0;    ///< Of all that the entity has.
  /// As asked for, with the bound that images have to keep.
  RepresentationOptions representation;

  [[nodiscard]] bool is_skipped() const { return !plan.skipped_reason.empty(); }

  /// How much of the training time this entity should get, beside others. Larger values need more
  /// of it, but not in proportion. Zero where it is skipped.
  [[nodiscard]] double weight() const;
};

/// Finds the recorded snapshots of an entity and the bound of its images (from their noise where
/// none was given), or the reason to skip it. Reads what was recorded, trains nothing.
/// Errors: kCancelled; those of the store.
Result<PlannedEntity> plan_entity(const EntityWork& work);

}  // namespace engram::training
