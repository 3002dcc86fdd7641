// SPDX-License-Identifier: Apache-2.0
#include "memory/replay_control.h"

namespace engram {

Status control_replay(Memory& memory, const ReplayCommand& command) {
  ENGRAM_RETURN_IF_ERROR(command.validate());
  // A robot would take the command for a snapshot like any other.
  ENGRAM_RETURN_IF_ERROR(replay_state(memory).status());
  return memory.commit(commit_of(command), CommitDurability::kMemory);
}

Result<ReplayState> replay_state(Memory& memory) {
  const ltm::MemoryId& clock = replay_clock_entity();
  const auto answer = memory.query(ltm::Query::of_entity(clock, ltm::select::Latest{}), "");
  const ltm::EntityResult* entity = answer.ok() ? answer->find_entity(clock) : nullptr;
  if (answer.status().code() == StatusCode::kNotFound ||
      (answer.ok() && (entity == nullptr || entity->snapshots.empty())))
    return failed_precondition("is no replay: it has no '{}'", clock.to_string());
  ENGRAM_RETURN_IF_ERROR(answer.status());
  const ltm::SnapshotResult& latest = entity->snapshots.back();
  if (latest.instances.empty())
    return failed_precondition("'{}' has no value, needs one", clock.to_string());
  return ReplayState::from_data(latest.instances.front().data);
}

}  // namespace engram
