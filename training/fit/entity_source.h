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

/// The recorded snapshots of an entity that one model can learn: those with the layout of the
/// newest one.
///
/// The layout is that of the value, with the kinds of its segment's type (orientations). Whole
/// numbers that no double holds, such as today's time in nanoseconds, are remainder.
struct EntitySource {
  std::vector<ltm::SnapshotEntry> entries;
  idf::Layout layout;
  uint64_t left_behind = 0;    ///< Recorded snapshots of another layout.
  uint64_t augmented = 0;      ///< Left-out augmented snapshots, which are never encoded.
  uint64_t new_snapshots = 0;  ///< Snapshots in `entries` without latents.
  uint64_t plain_bytes = 0;    ///< Size of the values in `entries`.
  std::string missing;         ///< Reason why there are too few; else empty.

  /// Finds sealed snapshots; the others are left to the next night. If there are fewer than `min`,
  /// or `needs_news` and all have latents, the reason is in `missing`.
  /// Errors: kCancelled; the errors of the store.
  static Result<EntitySource> find(ltm::StoreReader& reader, const ltm::MemoryId& entity,
                                   size_t min, bool needs_news, const std::stop_token& stop);

  /// Returns a source of the first instance of each of `entries`. Reader and entity must outlive
  /// it.
  static TrainingSource values(ltm::StoreReader& reader, const ltm::MemoryId& entity,
                               const idf::Layout& layout, std::vector<ltm::SnapshotEntry> entries);
};

}  // namespace engram::training
