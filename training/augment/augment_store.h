// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "augmentation/augment.h"
#include "ltm/core/progress.h"
#include "ltm/memory/memory_id.h"
#include "ltm/memory/query.h"

namespace engram::training {

/// Which snapshots are changed, how, and how often.
struct AugmentOptions {
  /// What is changed; more time is more snapshots.
  ltm::Query query;
  /// What recipes are drawn from. Empty: augmentation::usual_changes.
  std::vector<augmentation::ChangeChoice> changes;
  /// Of changes that are not named themselves.
  int strength_percent = 50;
  /// Changed snapshots per snapshot: further instances of the same moment. 1 to kMostCopies.
  int copies = 1;
  uint64_t seed = 1;
  /// Snapshots of so long a time share a recipe, over all entities, but for its noise: what moves
  /// keeps moving. Zero: each has its own.
  Duration hold = std::chrono::seconds(4);
  /// Members of the values that are labels or points.
  augmentation::SceneMembers members;
  /// An entity whose first image tells, at the same moment, which object is seen; empty: none.
  std::optional<ltm::MemoryId> mask_entity;
  /// The object to recolour or replace, as labels have it; 0: everything that has one.
  int64_t label = 0;
  /// How images are stored, see ltm/codec/codec_text.h.
  std::string image_codec = "png";

  static constexpr int kMostCopies = 64;

  [[nodiscard]] Status validate() const;
};

/// What became of one entity.
struct AugmentedEntity {
  ltm::MemoryId entity;
  std::string skipped_reason;  ///< Empty where there is something to change.
  uint64_t snapshots = 0;      ///< That were changed.
  uint64_t instances = 0;      ///< That were made of them.
  uint64_t left_out = 0;       ///< Not recorded any more, changed already, or without images.
  uint64_t without_mask = 0;   ///< Left out: the entity of the mask has nothing at that moment.
  uint64_t stored_bytes = 0;
};

struct AugmentReport {
  std::vector<AugmentedEntity> entities;
  uint64_t damaged_places = 0;  ///< In journals of the store that was read.
  bool is_cancelled = false;
};

/// The recipe of copy `copy` of what was seen at `time`. Depends on nothing else.
/// Source: docs/augmentation.md, section "Recipes".
[[nodiscard]] augmentation::Recipe recipe_at(const AugmentOptions& options, Time time, int copy);

/// Makes a new store of changed snapshots. Each keeps its entity, time and metadata, and names the
/// instance that it was made of and the recipe; instance i of copy k is number k n + i of n.
/// Nothing is filtered. Where it was stopped, what is there is whole.
/// Errors: kAlreadyExists where `to` is there; kNotFound where no entity matches; kInvalidArgument;
/// those of the stores.
Result<AugmentReport> augment_store(const std::filesystem::path& from,
                                    const std::filesystem::path& to, const AugmentOptions& options,
                                    const ProgressSink& progress, const std::stop_token& stop);

}  // namespace engram::training
