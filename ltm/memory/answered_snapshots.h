// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "ltm/memory/result.h"
#include "ltm/memory/snapshot.h"

namespace engram::ltm {

/// A snapshot of an answer as it was committed: without source, errors and indices.
[[nodiscard]] Snapshot to_snapshot(const MemoryId& entity, const SnapshotResult& answered);

/// The snapshots of an answer that are not predicted and have instances, entity by entity.
[[nodiscard]] std::vector<Snapshot> answered_snapshots(const QueryResult& answer);

/// The names of an entity as a query, or a subscription, names it and nothing else. Needs an ID of
/// an entity or deeper (checked).
[[nodiscard]] std::string exact_names(const MemoryId& id);

}  // namespace engram::ltm
