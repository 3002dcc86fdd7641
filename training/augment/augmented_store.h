// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "ltm/core/status.h"
#include "ltm/core/time.h"
#include "ltm/memory/memory_id.h"
#include "ltm/memory/query.h"

namespace engram::training {

/// Options of all ways to make augmented stores.
struct AugmentedStoreOptions {
  /// Selects the snapshots to change; a longer time selects more of them.
  ltm::Query query;
  /// Strength of changes that do not give their own: 1 to 100.
  int strength_percent = 50;
  /// Number of changed copies, each with its own recipe, as further instances of the same moment: 1
  /// to kMaxCopies.
  int copies = 1;
  uint64_t seed = 1;
  /// Time during which snapshots of all entities share a recipe, except for its noise, so that
  /// motion stays continuous. Zero for one recipe per snapshot.
  Duration hold = std::chrono::seconds(4);
  /// Codec of images, see ltm/codec/codec_text.h.
  std::string image_codec = "png";

  static constexpr int kMaxCopies = 64;

  [[nodiscard]] Status validate() const;
};

/// The result for one entity.
struct AugmentedEntity {
  ltm::MemoryId entity;
  std::string skipped_reason;  ///< Empty if there was something to change.
  uint64_t snapshots = 0;      ///< Changed snapshots.
  uint64_t instances = 0;      ///< Instances that were made of them.
  /// Left out: no longer recorded, augmented already, or without images.
  uint64_t left_out = 0;
  uint64_t without_mask = 0;   ///< Left out: the entity of the mask has no snapshot at that moment.
  uint64_t without_scene = 0;  ///< Left out: the scene is not fully remembered.
  uint64_t stored_bytes = 0;
};

struct AugmentReport {
  std::vector<AugmentedEntity> entities;
  uint64_t damaged_places = 0;  ///< Damaged places in journals of the source store.
  bool is_cancelled = false;
};

}  // namespace engram::training
