// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <vector>

#include "ltm/saliency/stored_saliency.h"
#include "ltm/store/store_reader.h"

namespace engram::ltm {

/// All snapshots of an entity in the order of time.
/// Errors: those of Timeline::for_each.
Result<std::vector<SnapshotEntry>> entries_of(StoreReader& store, const MemoryId& entity);

/// Parts that are not written yet, by segment and entity.
///
/// Threading: one thread.
class PendingSaliency {
 public:
  /// What is gathered before it is to be written. Unit: snapshots.
  static constexpr size_t kMaxPending = 2'000'000;

  explicit PendingSaliency(StoreReader& store) : store_(store) {}

  /// Adds the parts of a snapshot, in the order of time. Those of snapshots in journals are
  /// dropped.
  void add(const MemoryId& entity, const SnapshotEntry& entry, const StoredParts& parts);

  [[nodiscard]] bool is_full() const { return count_ >= kMaxPending; }

  /// Writes what was added. What is there of other snapshots stays.
  /// Errors: kUnavailable, kResourceExhausted.
  Status write();

 private:
  static std::vector<std::byte> merged(std::span<const std::byte> there,
                                       std::map<MemoryId, EntitySaliency>& entities);

  StoreReader& store_;
  std::map<uint32_t, std::map<MemoryId, EntitySaliency>> by_segment_;
  size_t count_ = 0;
};

/// The parts of all snapshots of a store, which go into the new segments when segments are
/// rewritten. What a snapshot was worth among all others does not change because those are gone.
class KeptSaliency {
 public:
  /// It takes 20 bytes of memory for each snapshot.
  static KeptSaliency read(StoreReader& store);

  /// Gives segments without an index the parts of the snapshots that they have.
  /// Errors: those of StoreReader::open and PendingSaliency::write.
  Status restore(const std::filesystem::path& store) const;

 private:
  std::map<MemoryId, EntitySaliency> entities_;
};

/// Removes what was calculated of these entities, because what it was calculated beside is erased.
/// The next night calculates it anew.
/// Errors: those of StoreReader::open and edit_segment_index.
Status remove_saliency_of(const std::filesystem::path& store, const std::set<MemoryId>& entities);

}  // namespace engram::ltm
