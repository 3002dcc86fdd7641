// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "ltm/core/time_set.h"
#include "ltm/working/held_snapshot.h"

namespace engram::ltm {

/// The snapshots of one entity that are in working memory, in the order of time.
///
/// The oldest ones may have been chosen to leave; they stay readable until they are stored.
/// Threading: one thread writes; several may read at once.
class EntityHistory {
 public:
  struct Entry {
    Entry(SharedSnapshot shared, Time came, size_t plain_bytes)
        : time(shared->time), snapshot(std::move(shared)), arrived(came), bytes(plain_bytes) {}

    Time time;  ///< A copy, so that searches do not touch the snapshot.
    SharedSnapshot snapshot;
    Time arrived{};
    size_t bytes = 0;
    bool is_queued = false;  ///< It waits for the online phase.
    bool is_stored = false;  ///< The online phase took it.
  };

  [[nodiscard]] bool empty() const { return entries_.empty(); }
  [[nodiscard]] size_t size() const { return entries_.size(); }
  [[nodiscard]] const Entry& operator[](size_t index) const { return entries_[index]; }
  [[nodiscard]] Entry& operator[](size_t index) { return entries_[index]; }
  [[nodiscard]] const Entry& back() const { return entries_.back(); }

  /// The number of snapshots that were chosen to leave, which are the first ones.
  [[nodiscard]] size_t leaving() const { return leaving_; }
  [[nodiscard]] size_t staying() const { return entries_.size() - leaving_; }

  /// The index of the first snapshot that is not before `time`; size() where there is none.
  /// Complexity: O(1) where snapshots come at regular intervals, otherwise O(log n).
  [[nodiscard]] size_t lower_bound(Time time) const;

  /// The index of the snapshot of exactly this time.
  [[nodiscard]] std::optional<size_t> find(Time time) const;

  /// Where put() placed an entry. An entry of the same time is replaced and returned. An entry
  /// before one that is leaving leaves too.
  /// Complexity: O(log n) and one move for each later entry, or for each earlier one if these are
  /// fewer.
  struct Placed {
    size_t index = 0;
    std::optional<Entry> replaced;
    bool is_leaving = false;
  };
  Placed put(Entry entry);

  /// Chooses the oldest snapshot that stays, to leave. Needs one (checked).
  Entry& choose_oldest();

  void erase(size_t index);

  /// Removes the entries of these times and returns them, in the order of time.
  /// Complexity: O(n log t) for t times.
  struct Taken {
    Entry entry;
    bool was_leaving = false;
  };
  std::vector<Taken> take(const TimeSet& times);

 private:
  std::deque<Entry> entries_;
  size_t leaving_ = 0;
};

}  // namespace engram::ltm
