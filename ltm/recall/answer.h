// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ltm/memory/result.h"
#include "ltm/working/held_snapshot.h"

namespace engram::ltm {

/// One moment of an answer.
struct RecalledSnapshot {
  SnapshotResult answer;  ///< Has no data if the query asks for IDs only.
  /// The snapshot in working memory, or null if it is not there. A server sends its bytes as they
  /// came instead of encoding them again.
  SharedSnapshot held{};
};

struct RecalledEntity {
  MemoryId id;
  std::vector<RecalledSnapshot> snapshots;  ///< Sorted by time; may be empty.
};

/// What a memory answers to a query. Entities are sorted by their IDs.
struct Answer {
  bool is_ids_only = false;
  std::vector<RecalledEntity> entities;

  /// Converts the answer to a tree of the six levels.
  [[nodiscard]] QueryResult to_result() &&;
};

/// What an answer tells of a moment, as a snapshot of `entity`.
[[nodiscard]] Snapshot to_snapshot(const MemoryId& entity, SnapshotResult told);

/// Makes a moment of an answer from a snapshot of working memory. `instances` selects instances by
/// index; empty selects all. The result has no instances if none of the selected ones exists.
[[nodiscard]] RecalledSnapshot recalled(SharedSnapshot held, const std::vector<int32_t>& instances,
                                        bool is_ids_only);

}  // namespace engram::ltm
