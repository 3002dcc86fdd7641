// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: parts of the segment writer.

#include <map>
#include <span>
#include <utility>
#include <vector>

#include "ltm/idf/layout.h"
#include "ltm/store/segment_writer.h"

namespace engram::ltm {

/// An entity of a new segment. What it refers to must outlive it.
using EntityRef = std::pair<const MemoryId*, const RecordedEntity*>;

/// Number of instances.
[[nodiscard]] size_t row_count_of(const RecordedEntity& entity);

/// Which entities of a new segment have a group of their own, and which share the rows of one.
struct GroupPlan {
  std::vector<EntityRef> alone;
  /// The entities of each shared group, in the order of their IDs.
  std::vector<std::vector<EntityRef>> shared;
};

/// Entities of which a segment has few rows share groups with those of the same layout, because a
/// group takes a millisecond to write and 5 kB, however little is in it. Where a segment has few
/// such entities, each has its own.
/// Complexity: O(rows).
/// Source: docs/format.md, "Shared groups".
[[nodiscard]] GroupPlan plan_groups(const std::map<MemoryId, RecordedEntity>& entities);

}  // namespace engram::ltm
