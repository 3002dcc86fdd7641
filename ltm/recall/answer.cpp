// SPDX-License-Identifier: Apache-2.0
#include "ltm/recall/answer.h"

namespace engram::ltm {

QueryResult Answer::to_result() && {
  QueryResult result(is_ids_only);
  for (RecalledEntity& entity : entities) {
    EntityResult& one = result.add_entity(entity.id);
    for (RecalledSnapshot& snapshot : entity.snapshots) one.add(std::move(snapshot.answer));
  }
  return result;
}

RecalledSnapshot recalled(SharedSnapshot held, const std::vector<int32_t>& instances,
                          bool is_ids_only) {
  return {result_of(*held, instances, is_ids_only), std::move(held)};
}

Snapshot to_snapshot(const MemoryId& entity, SnapshotResult told) {
  Snapshot snapshot{entity, told.time, {}};
  for (InstanceResult& instance : told.instances)
    snapshot.instances.push_back({std::move(instance.data), std::move(instance.metadata)});
  return snapshot;
}

}  // namespace engram::ltm
