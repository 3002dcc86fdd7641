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

/// Applies `selector` to the times of an entity's snapshots, which strictly increase.
/// Complexity: O(log n).
[[nodiscard]] Selection select_times(const Selector& selector, std::span<const Time> times);

}  // namespace engram::ltm
