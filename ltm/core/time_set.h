// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <span>
#include <vector>

#include "ltm/core/time.h"

namespace engram {

/// A sorted set of times, as std::set, that needs 8 bytes per time.
///
/// Complexity: inserting after the last time is O(1), elsewhere O(size).
class TimeSet {
 public:
  using const_iterator = std::vector<Time>::const_iterator;
  using value_type = Time;

  TimeSet() = default;
  TimeSet(std::initializer_list<Time> times);
  explicit TimeSet(std::vector<Time> times);

  /// Returns false where the time was present.
  bool insert(Time time);

  /// Complexity: O(size of both).
  void insert_all(const TimeSet& others);

  [[nodiscard]] bool contains(Time time) const;

  /// True where a time lies in [first, last].
  [[nodiscard]] bool has_any_in(Time first, Time last) const;

  [[nodiscard]] const_iterator begin() const { return times_.begin(); }
  [[nodiscard]] const_iterator end() const { return times_.end(); }
  [[nodiscard]] Time front() const { return times_.front(); }
  [[nodiscard]] Time back() const { return times_.back(); }
  [[nodiscard]] size_t size() const { return times_.size(); }
  [[nodiscard]] bool empty() const { return times_.empty(); }

  friend bool operator==(const TimeSet&, const TimeSet&) = default;

 private:
  std::vector<Time> times_;
};

}  // namespace engram
