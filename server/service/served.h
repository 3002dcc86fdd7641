// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ltm/memory/result.h"
#include "server/memory/held_snapshot.h"

namespace engram::server {

/// One moment of an answer.
struct ServedSnapshot {
  ltm::SnapshotResult answer;  ///< Without data where only IDs were asked for.
  /// What it is where it was in working memory: its bytes need not be made anew.
  SharedSnapshot held;
};

struct ServedEntity {
  ltm::MemoryId id;
  std::vector<ServedSnapshot> snapshots;  ///< In the order of time; may be empty.
};

/// The answer of one server, entities in the order of their IDs.
struct ServedAnswer {
  bool is_ids_only = false;
  std::vector<ServedEntity> entities;

  [[nodiscard]] ltm::QueryResult to_result() const;
};

/// A snapshot of working memory as a moment of an answer; `instances`: which, empty for all.
/// Without any of these it has no instances.
[[nodiscard]] ServedSnapshot serve(SharedSnapshot held, const std::vector<int32_t>& instances,
                                   bool is_ids_only);

}  // namespace engram::server
