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

/// What all ways to make augmented stores have in common.
struct AugmentedStoreOptions {
  /// What snapshots are made of; more time is more snapshots.
  ltm::Query query;
  /// How far changes may go, where they do not say so themselves. 1 to 100.
  int strength_percent = 50;
  /// Drawn anew so many times: further instances of the same moment. 1 to kMaxCopies.
  int copies = 1;
  uint64_t seed = 1;
  /// Snapshots of so long a time share a recipe, over all entities, but for its noise: what moves
  /// keeps moving. Zero: each has its own.
  Duration hold = std::chrono::seconds(4);
  /// How images are stored, see ltm/codec/codec_text.h.
  std::string image_codec = "png";

  static constexpr int kMaxCopies = 64;

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
  uint64_t without_scene = 0;  ///< Left out: not all that was there is remembered.
  uint64_t stored_bytes = 0;
};

struct AugmentReport {
  std::vector<AugmentedEntity> entities;
  uint64_t damaged_places = 0;  ///< In journals of the store that was read.
  bool is_cancelled = false;
};

}  // namespace engram::training
