// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "ltm/core/time_set.h"
#include "ltm/store/store_reader.h"

// Private to this room.

namespace engram::training {

/// Consecutive snapshots whose latents share no block with any other snapshot, so they can be coded
/// anew without the others.
struct FadingGroup {
  std::vector<ltm::SnapshotEntry> entries;
  std::vector<ltm::LatentSnapshot> latents;  ///< Of the same snapshots.

  /// Number of latents of all instances.
  [[nodiscard]] size_t rows() const;
  /// Version of the model that made the latents.
  [[nodiscard]] int model_version() const { return latents.front().model_version; }
  /// Adds one of its own snapshots to a part of this group.
  void add_to(FadingGroup& part, size_t snapshot) const;
  /// Adds the snapshots of a later group of the same model.
  void add(FadingGroup later);
  /// Bytes of the blocks.
  [[nodiscard]] uint64_t bytes() const;
  /// Puts others in place of the codes and qualities of all instances, of which there are as many
  /// (checked).
  void replace(std::vector<ltm::Latent> codes, std::span<const ltm::LatentQuality> qualities);
};

/// Whether a block of a group has lost rows: they were forgotten, replaced, or recorded again.
[[nodiscard]] bool is_cut(const FadingGroup& group);

/// Calls `visit` with each group of which all snapshots are in `times`, in the order of time.
/// Returns the number of those snapshots in `times` that are in a group with others.
///
/// It reads the latents from the first to the last of `times` and of their groups, and keeps those
/// of one group.
/// Errors: those of the store and of `visit`.
/// Threading: one thread.
Result<uint64_t> for_each_group(ltm::StoreReader& reader, const ltm::MemoryId& entity,
                                const TimeSet& times,
                                const std::function<Status(FadingGroup)>& visit);

}  // namespace engram::training
