// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <span>
#include <vector>

#include "ltm/core/mutex.h"
#include "ltm/memory/query.h"
#include "ltm/working/held_snapshot.h"

namespace engram::ltm {

/// What a live store has of each entity, as its writer reports it: the time of the last snapshot,
/// and the recording that changed it last. The latter tells whether a reader is too old.
///
/// Threading: thread-safe.
class RecordedEntities {
 public:
  /// Adds an entity that the store had when it was opened.
  void add(const MemoryId& entity, std::optional<Time> until);

  /// Corrects the last time of an entity after the store has forgotten some of it; empty: the store
  /// has nothing of it any more. Nobody may record meanwhile.
  void correct(const MemoryId& entity, std::optional<Time> until);

  /// Call begin() before snapshots are recorded and finish() after it. With begin() nobody takes an
  /// older state of the store for the newest one.
  void begin(std::span<const SharedSnapshot> snapshots);
  /// `released`: what else the recording stored, of which earlier ones began.
  void finish(std::span<const SharedSnapshot> snapshots, std::span<const MemoryId> released);

  /// An upper bound of the entity's times in the store; empty if the store has no snapshot of it.
  /// Complexity: O(log n).
  [[nodiscard]] std::optional<Time> known_until(const MemoryId& entity) const;

  [[nodiscard]] bool contains(const MemoryId& entity) const;
  [[nodiscard]] size_t size() const;

  /// Number of the last recording that changed the entity. Recordings of a store count from one.
  [[nodiscard]] uint64_t recorded_at(const MemoryId& entity) const;

  /// Number of the last recording.
  [[nodiscard]] uint64_t recordings() const;

  /// The entities that match a query, sorted by their IDs.
  [[nodiscard]] std::vector<MemoryId> matching(const Query& query) const;

  /// Snapshots that were recorded since the last call. What was read of them before may be old.
  struct Changed {
    std::vector<MemoryId> snapshots;
    bool is_all = false;  ///< There were too many to list: anything may be old.
  };
  [[nodiscard]] Changed take_changed();

 private:
  void note_changed(MemoryId snapshot) ENGRAM_REQUIRES(mutex_);

  struct Recorded {
    std::optional<Time> until;
    uint64_t at = 0;
  };

  mutable SharedMutex mutex_;
  std::map<MemoryId, Recorded> entities_ ENGRAM_GUARDED_BY(mutex_);
  uint64_t recordings_ ENGRAM_GUARDED_BY(mutex_) = 0;
  Changed changed_ ENGRAM_GUARDED_BY(mutex_);
};

}  // namespace engram::ltm
