// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <span>
#include <vector>

#include "ltm/core/mutex.h"
#include "ltm/memory/query.h"
#include "ltm/store/entity_index.h"
#include "ltm/working/held_snapshot.h"

namespace engram::ltm {

/// What a live store has of each entity, as its writer reports it: the time of the last snapshot,
/// and the recording that changed it last. The latter tells whether a reader is too old.
///
/// Threading: thread-safe.
class RecordedEntities {
 public:
  /// What the store had when it was opened: in its segments, and in unsealed journals. Call it
  /// once, before anything else.
  void begin_with(EntityIndex sealed, const std::map<MemoryId, std::optional<Time>>& journals);

  /// Corrects the last time of an entity after the store has forgotten some of it; empty: the store
  /// has nothing of it any more. Nobody may record meanwhile.
  void correct(const MemoryId& entity, std::optional<Time> until);

  /// Call begin() before snapshots are recorded and finish() after it. With begin() nobody takes an
  /// older state of the store for the newest one.
  void begin(std::span<const SharedSnapshot> snapshots);
  /// `released`: what else the recording stored, of which earlier ones began.
  void finish(std::span<const SharedSnapshot> snapshots, std::span<const MemoryId> released);

  /// An upper bound of the entity's times in the store; empty if the store has no snapshot of it.
  [[nodiscard]] std::optional<Time> known_until(const MemoryId& entity) const;

  [[nodiscard]] bool contains(const MemoryId& entity) const;
  /// Reads the names of all, once.
  [[nodiscard]] size_t size() const;
  /// At least as many as there are, without reading their names.
  [[nodiscard]] size_t max_size() const;

  /// Number of the last recording that changed the entity. Recordings of a store count from one.
  [[nodiscard]] uint64_t recorded_at(const MemoryId& entity) const;

  /// Number of the last recording.
  [[nodiscard]] uint64_t recordings() const;

  /// The entities that match a query, sorted by their IDs. Reads the names of all, once, unless the
  /// query names its entities.
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
    bool is_gone = false;  ///< It stands in a segment's list still.
  };

  /// Null if the store has nothing of it.
  Recorded* find(const MemoryId& entity) const ENGRAM_REQUIRES(mutex_);
  Recorded& find_or_add(const MemoryId& entity) ENGRAM_REQUIRES(mutex_);
  void read_all() const ENGRAM_REQUIRES(mutex_);

  mutable SharedMutex mutex_;
  /// What the store had when it was opened, until the names of all are needed.
  mutable EntityIndex sealed_ ENGRAM_GUARDED_BY(mutex_);
  mutable bool has_all_ ENGRAM_GUARDED_BY(mutex_) = true;
  /// Those that were recorded since or asked for, or all.
  mutable std::map<MemoryId, Recorded> entities_ ENGRAM_GUARDED_BY(mutex_);
  size_t not_sealed_ ENGRAM_GUARDED_BY(mutex_) = 0;  ///< Of `entities_`, until all are read.
  uint64_t recordings_ ENGRAM_GUARDED_BY(mutex_) = 0;
  Changed changed_ ENGRAM_GUARDED_BY(mutex_);
};

}  // namespace engram::ltm
