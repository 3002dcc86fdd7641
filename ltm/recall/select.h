// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "ltm/memory/query.h"

namespace engram::ltm {

/// What a selector means for one entity.
struct Selection {
  /// Snapshots [first, first + count) of the entity, in the order of time.
  size_t first = 0;
  size_t count = 0;
  /// A moment after the last snapshot that is asked for.
  std::optional<Time> future;
};

/// One snapshot that is asked for.
struct SelectedSnapshot {
  size_t index = 0;            ///< Among the entity's snapshots; of no meaning for a future one.
  std::optional<Time> future;  ///< The moment after the last snapshot that is asked for.
  /// Indices of the instances that are asked for, increasing; empty: all.
  std::vector<int32_t> instances;

  friend bool operator==(const SelectedSnapshot&, const SelectedSnapshot&) = default;
};

/// Applies `selector` to the times of an entity's snapshots, which strictly increase.
/// Complexity: O(log n).
[[nodiscard]] Selection select_times(const Selector& selector, std::span<const Time> times);

/// Unites what several selectors mean for one entity: in the order of time, each moment once, with
/// all the instances that any of them asks for.
/// Complexity: O(m log m) in the number of answers.
[[nodiscard]] std::vector<SelectedSnapshot> select_snapshots(
    std::span<const SnapshotQuery> queries, std::span<const Time> times);

}  // namespace engram::ltm
