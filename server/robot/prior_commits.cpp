// SPDX-License-Identifier: Apache-2.0
#include "server/robot/prior_commits.h"

#include <algorithm>

#include "memory/prior/prior.h"

namespace engram::server {

namespace {

bool is_known(memory::MemoryService& service, const ltm::EntityUpdate& update) {
  // A time range, not `At`: a query at a time after the last snapshot would be answered by a
  // prediction.
  const auto query =
      ltm::Query::of_entity(update.entity, ltm::select::TimeRange{update.time, update.time});
  const auto answer = service.query(query);
  if (!answer.ok() || answer->entities.size() != 1) return false;
  const auto& snapshots = answer->entities.front().snapshots;
  if (snapshots.size() != 1) return false;
  return std::ranges::equal(snapshots.front().answer.instances, update.instances,
                            [](const ltm::InstanceResult& known, const ltm::Instance& instance) {
                              return known.data == instance.data;
                            });
}

}  // namespace

Result<PriorCounts> commit_prior(MemoryServer& server, const std::filesystem::path& directory) {
  ENGRAM_ASSIGN_OR_RETURN(memory::PriorKnowledge prior, memory::load_prior(directory));
  memory::MemoryService& service = server.service();
  for (const auto& [segment, type] : prior.types.all())
    ENGRAM_RETURN_IF_ERROR(service.declare(segment, type));
  PriorCounts counts;
  for (auto& [memory, commit] : prior.commits) {
    ENGRAM_RETURN_IF_ERROR(service.owns(commit.updates.front().entity));
    counts.entities += commit.updates.size();
    counts.known += std::erase_if(
        commit.updates, [&](const ltm::EntityUpdate& update) { return is_known(service, update); });
    if (!commit.updates.empty()) ENGRAM_RETURN_IF_ERROR(server.commit(std::move(commit)));
  }
  return counts;
}

}  // namespace engram::server
