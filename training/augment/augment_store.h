// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <stop_token>
#include <vector>

#include "augmentation/augment.h"
#include "ltm/core/progress.h"
#include "training/augment/augmented_store.h"

namespace engram::training {

/// How images are changed.
struct AugmentOptions : AugmentedStoreOptions {
  /// What recipes are drawn from. Empty: augmentation::usual_changes.
  std::vector<augmentation::ChangeChoice> changes;
  /// Members of the values that are labels or points.
  augmentation::SceneMembers members;
  /// An entity whose first image tells, at the same moment, which object is seen; empty: none.
  std::optional<ltm::MemoryId> mask_entity;
  /// The object to recolour or replace, as labels have it; 0: everything that has one.
  int64_t label = 0;

  [[nodiscard]] Status validate() const;
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
