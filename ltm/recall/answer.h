// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ltm/memory/result.h"
#include "ltm/working/held_snapshot.h"

namespace engram::ltm {

/// One moment of an answer.
struct RecalledSnapshot {
  SnapshotResult answer;  ///< Without data where only IDs were asked for.
  /// What it is in working memory, else null: a server sends these bytes as they came, instead of
  /// making them anew.
  SharedSnapshot held{};
};

struct RecalledEntity {
  MemoryId id;
  std::vector<RecalledSnapshot> snapshots;  ///< In the order of time; may be empty.
};

/// What a memory answers to a query, entities in the order of their IDs.
struct Answer {
  bool is_ids_only = false;
  std::vector<RecalledEntity> entities;

  /// The same as a tree of the six levels.
  [[nodiscard]] QueryResult to_result() &&;
};

/// A snapshot of working memory as a moment of an answer; `instances`: which, empty for all.
/// Without any of these it has no instances.
[[nodiscard]] RecalledSnapshot recalled(SharedSnapshot held, const std::vector<int32_t>& instances,
                                        bool is_ids_only);

}  // namespace engram::ltm
