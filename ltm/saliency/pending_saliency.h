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

/// Rows that are not written yet, by segment and entity.
///
/// Threading: one thread.
class PendingSaliency {
 public:
  /// What is gathered before it is to be written. Unit: snapshots.
  static constexpr size_t kMaxPending = 2'000'000;

  explicit PendingSaliency(StoreReader& store) : store_(store) {}

  /// Adds what is known of a snapshot, in the order of time. Snapshots in journals are left out.
  void add(const MemoryId& entity, const SnapshotEntry& entry, const SaliencyRow& row);

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

/// What is known of all snapshots of a store, which goes into the new segments when segments are
/// rewritten. What a snapshot was worth among all others does not change because those are gone.
class KeptSaliency {
 public:
  /// It takes 28 bytes of memory for each snapshot.
  /// Errors: those of StoreReader::open.
  static Result<KeptSaliency> read(const std::filesystem::path& store);

  /// Leaves no parts of these entities: they are calculated anew.
  void make_stale(const std::set<MemoryId>& entities);

  /// Gives segments without an index the rows of the snapshots that they have. A snapshot that is
  /// gone counts for the one before it from now on, if one of its entity is left there.
  /// Errors: those of StoreReader::open and PendingSaliency::write.
  Status restore(const std::filesystem::path& store) const;

  /// Runs a job that rewrites segments, and restores what it dropped, also if the job failed.
  /// Errors: those of the job first.
  template <typename Job>
  auto carry_over(const std::filesystem::path& store, const Job& job) const -> decltype(job()) {
    auto done = job();
    const Status restored = restore(store);
    if (done.ok() && !restored.ok()) return restored;
    return done;
  }

 private:
  std::map<MemoryId, EntitySaliency> entities_;
};

/// Removes the parts of these entities, because what they were calculated beside is erased. The
/// next night calculates them anew. How many snapshots each stands for stays.
/// Errors: those of StoreReader::open and edit_segment_index.
Status make_saliency_stale(const std::filesystem::path& store, const std::set<MemoryId>& entities);

}  // namespace engram::ltm
