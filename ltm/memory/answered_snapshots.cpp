// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/answered_snapshots.h"

#include "ltm/memory/query_builder.h"

namespace engram::ltm {

Snapshot to_snapshot(const MemoryId& entity, const SnapshotResult& answered) {
  Snapshot snapshot{entity, answered.time, {}};
  for (const InstanceResult& instance : answered.instances)
    snapshot.instances.push_back({instance.data, instance.metadata});
  return snapshot;
}

std::vector<Snapshot> answered_snapshots(const QueryResult& answer) {
  std::vector<Snapshot> snapshots;
  for (const EntityResult* entity : answer.entities())
    for (const SnapshotResult& one : entity->snapshots)
      if (one.source != Source::kPredicted && !one.instances.empty())
        snapshots.push_back(to_snapshot(entity->id, one));
  return snapshots;
}

std::string exact_names(const MemoryId& id) {
  std::vector<std::string> levels;
  for (const NamePattern& level : path_of(id.entity())) levels.push_back(level.to_string());
  return fmt::format("{}", fmt::join(levels, "/"));
}

}  // namespace engram::ltm
