// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "ltm/idf/layout.h"
#include "ltm/store/store_reader.h"
#include "training/fit/training_source.h"

// Internal to the learning rooms.

namespace engram::training {

/// The recorded snapshots of an entity that one model can learn: those of the newest one's layout.
///
/// The layout is that of the value, with the kinds that its type tells (orientations); whole
/// numbers that no double holds, such as nanoseconds of today, are remainder.
struct EntitySource {
  std::vector<ltm::SnapshotEntry> entries;
  idf::Layout layout;
  uint64_t left_behind = 0;    ///< Recorded snapshots of another layout.
  uint64_t augmented = 0;      ///< Left out: they are trained on beside others, never encoded.
  uint64_t new_snapshots = 0;  ///< Of `entries`, those without latents.
  uint64_t plain_bytes = 0;    ///< Of `entries`.
  std::string missing;         ///< Why there are not enough; else empty.

  /// What is sealed: the rest is the next night's. Fewer than `min` are told in `missing`; and,
  /// where `needs_news`, that all have latents already.
  /// Errors: kCancelled; those of the store.
  static Result<EntitySource> find(ltm::StoreReader& reader, const ltm::MemoryId& entity,
                                   size_t min, bool needs_news, const std::stop_token& stop);

  /// The first instance of each of some snapshots. Reader and entity outlive it.
  static TrainingSource values(ltm::StoreReader& reader, const ltm::MemoryId& entity,
                               const idf::Layout& layout, std::vector<ltm::SnapshotEntry> entries);
};

}  // namespace engram::training
