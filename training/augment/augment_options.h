// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "augmentation/augment.h"
#include "ltm/memory/memory_id.h"
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

}  // namespace engram::training
