// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "augmentation/augment.h"
#include "ltm/memory/memory_id.h"
#include "training/augment/augmented_store.h"

namespace engram::training {

/// Options of changing images.
struct AugmentOptions : AugmentedStoreOptions {
  /// The changes from which recipes are drawn; empty for augmentation::usual_changes.
  std::vector<augmentation::ChangeChoice> changes;
  /// Members of the values that are labels or points.
  augmentation::SceneMembers members;
  /// An entity whose first image at the same moment has the labels of objects; empty for none.
  std::optional<ltm::MemoryId> mask_entity;
  /// Label of the object to recolour or replace; 0 for all labelled objects.
  int64_t label = 0;

  [[nodiscard]] Status validate() const;
};

}  // namespace engram::training
