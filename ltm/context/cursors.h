// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: finds rows and times that are asked for nearly in order.

#include <algorithm>
#include <cstdint>
#include <vector>

#include "ltm/context/entity_context.h"

namespace engram::ltm {

constexpr uint32_t kNoRow = UINT32_MAX;

/// The rows of snapshots in a table. Snapshots are asked for nearly in order, so the next rows are
/// where the last ones ended.
///
/// Threading: one thread. The column must outlive it.
class RowCursor {
 public:
  explicit RowCursor(const std::vector<uint32_t>& snapshots) : snapshots_(snapshots) {}

  struct Rows {
    size_t begin = 0, end = 0;
  };
  Rows of(uint32_t snapshot) {
    if (rows_.begin > 0 && snapshots_[rows_.begin - 1] >= snapshot)
      rows_.begin = first_row(snapshots_, snapshot);
    while (rows_.begin < snapshots_.size() && snapshots_[rows_.begin] < snapshot) ++rows_.begin;
    rows_.end = rows_.begin;
    while (rows_.end < snapshots_.size() && snapshots_[rows_.end] == snapshot) ++rows_.end;
    return rows_;
  }

 private:
  const std::vector<uint32_t>& snapshots_;
  Rows rows_;
};

/// Finds times, which are asked for nearly in order, too.
///
/// Threading: one thread. The column, which is sorted, must outlive it.
class TimeCursor {
 public:
  explicit TimeCursor(const std::vector<Time>& times) : times_(times) {}

  /// The last one until a time; kNoRow if there is none.
  uint32_t last_until(Time time) {
    if (behind_ > 0 && times_[behind_ - 1] > time)
      behind_ = static_cast<size_t>(std::ranges::upper_bound(times_, time) - times_.begin());
    while (behind_ < times_.size() && times_[behind_] <= time) ++behind_;
    return behind_ == 0 ? kNoRow : static_cast<uint32_t>(behind_ - 1);
  }

  /// The one of exactly this time; kNoRow if there is none.
  uint32_t at(Time time) {
    const uint32_t last = last_until(time);
    return last != kNoRow && times_[last] == time ? last : kNoRow;
  }

 private:
  const std::vector<Time>& times_;
  size_t behind_ = 0;  ///< One behind the last one until the time that was asked for.
};

}  // namespace engram::ltm
