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

/// The result of the first step: the plan for an entity and its snapshots.
struct PlannedEntity {
  EntityPlan plan;  ///< The plan as it is reported. A reason to skip the entity ends the work.
  std::vector<ltm::SnapshotEntry> entries;  ///< Recorded snapshots of one layout.
  idf::Layout layout;
  uint64_t left_behind = 0;  ///< Recorded snapshots of another layout.
  double plain_bytes = 0;    ///< Plain size of all snapshots of the entity.
  /// As requested, with the bound of images.
  RepresentationOptions representation;

  /// Whether all members are images, so that nothing is trained where they are kept as video.
  [[nodiscard]] bool has_images_alone() const;
  /// Whether a new model is compared with the newest one, and published only if it is cheaper. A
  /// representation that was asked for, other than auto, is made of images whatever it takes.
  [[nodiscard]] bool compares_models(const ConsolidateOptions& options) const;
  [[nodiscard]] bool is_skipped() const { return !plan.skipped_reason.empty(); }

  /// Weight of this entity in the division of the time of training. Larger entities need more time,
  /// but not in proportion. Zero if it is skipped.
  [[nodiscard]] double weight() const;
};

/// Finds the recorded snapshots of an entity and the bound of its images (from their noise if none
/// was given), or the reason to skip it. It reads the recorded snapshots and trains nothing.
/// Errors: kCancelled; the errors of the store.
Result<PlannedEntity> plan_entity(const EntityWork& work);

}  // namespace engram::training
