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

/// What a live store has of its entities, told by who writes to it: until when, and whether a
/// reader that was opened earlier can know of it.
///
/// Threading: thread-safe.
class RecordedEntities {
 public:
  /// What the store had when it was opened.
  void add(const MemoryId& entity, std::optional<Time> until);

  /// To be called before snapshots are recorded, so that nobody takes an older state of the store
  /// for the newest, and after it.
  void begin(std::span<const SharedSnapshot> snapshots);
  void finish(std::span<const SharedSnapshot> snapshots);

  /// No snapshot of the entity that is in the store is later. Nothing where none is in it.
  /// Complexity: O(log n).
  [[nodiscard]] std::optional<Time> known_until(const MemoryId& entity) const;

  /// Number of the recording that changed the entity last; those of one store count from one.
  [[nodiscard]] uint64_t recorded_at(const MemoryId& entity) const;

  /// Number of the last recording.
  [[nodiscard]] uint64_t recordings() const;

  /// Those that a query asks for, in the order of their IDs.
  [[nodiscard]] std::vector<MemoryId> matching(const Query& query) const;

  /// Snapshots that were recorded since the last call: what was read of them before may be old.
  struct Changed {
    std::vector<MemoryId> snapshots;
    bool is_all = false;  ///< They were too many to name: anything may be old.
  };
  [[nodiscard]] Changed take_changed();

 private:
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
