// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "ltm/working/held_snapshot.h"

namespace engram::ltm {

/// The snapshots of one entity that are in working memory, in the order of time.
///
/// Those that were chosen to leave are the oldest ones; they stay readable until they are stored.
/// Threading: one thread; several that read at once.
class EntityHistory {
 public:
  struct Entry {
    Entry(SharedSnapshot shared, Time came, size_t plain_bytes)
        : time(shared->time), snapshot(std::move(shared)), arrived(came), bytes(plain_bytes) {}

    Time time;  ///< Beside the snapshot: searches do not touch it.
    SharedSnapshot snapshot;
    Time arrived{};
    size_t bytes = 0;
    bool is_queued = false;  ///< Waits for the online phase.
    bool is_stored = false;  ///< The online phase took it.
  };

  [[nodiscard]] bool empty() const { return entries_.empty(); }
  [[nodiscard]] size_t size() const { return entries_.size(); }
  [[nodiscard]] const Entry& operator[](size_t index) const { return entries_[index]; }
  [[nodiscard]] Entry& operator[](size_t index) { return entries_[index]; }
  [[nodiscard]] const Entry& back() const { return entries_.back(); }

  /// How many were chosen to leave: the first ones.
  [[nodiscard]] size_t leaving() const { return leaving_; }
  [[nodiscard]] size_t staying() const { return entries_.size() - leaving_; }

  /// Index of the first one that is not before `time`; size() where there is none.
  /// Complexity: O(1) where they come at regular intervals, else O(log n).
  [[nodiscard]] size_t lower_bound(Time time) const;

  /// Index of the one of exactly this time.
  [[nodiscard]] std::optional<size_t> find(Time time) const;

  /// Puts it where its time belongs; one of the same time makes room and is given back. What lies
  /// before one that is leaving, leaves too.
  /// Complexity: O(log n) and as many moves as there are later ones, or earlier ones if fewer.
  struct Placed {
    size_t index = 0;
    std::optional<Entry> replaced;
    bool is_leaving = false;
  };
  Placed put(Entry entry);

  /// Chooses the oldest one that stays. Needs one (checked).
  Entry& choose_oldest();

  void erase(size_t index);

 private:
  std::deque<Entry> entries_;
  size_t leaving_ = 0;
};

}  // namespace engram::ltm
