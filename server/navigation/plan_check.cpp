// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/plan_check.h"

#include <map>

#include "server/navigation/known_things.h"

namespace engram::navigation {

namespace {

std::string time_text(const ltm::MemoryId& id) {
  return id.time() ? engram::to_string(*id.time()) : std::string("an unknown time");
}

}  // namespace

Status check_map(Memory& memory, const CostMap& map, const MapRules& rules) {
  ENGRAM_ASSIGN_OR_RETURN(const FloorThings now, known_things(memory, rules));
  std::map<ltm::MemoryId, const Obstacle*> mapped;
  for (const Obstacle& obstacle : map.obstacles)
    if (obstacle.snapshot.has_entity()) mapped[obstacle.snapshot.entity()] = &obstacle;
  for (const Obstacle& found : now.obstacles()) {
    const ltm::MemoryId entity = found.snapshot.entity();
    const auto before = mapped.find(entity);
    if (before == mapped.end())
      return failed_precondition(
          "'{}' came: the map of {} does not know it, the memory does as of {}", entity.printable(),
          time_text(map.id), time_text(found.snapshot));
    if (!before->second->is_at(found))
      return failed_precondition("'{}' was moved: the map knows it as of {}, the memory as of {}",
                                 entity.printable(), time_text(before->second->snapshot),
                                 time_text(found.snapshot));
    mapped.erase(before);
  }
  for (const auto& [entity, obstacle] : mapped) {
    const auto time = now.time_of(entity);
    return failed_precondition(
        "'{}' is no longer in the way: the map knows it as of {}, the memory as of {}",
        entity.printable(), time_text(obstacle->snapshot),
        time ? engram::to_string(*time) : std::string("never"));
  }
  return {};
}

Status check_plan(Memory& memory, const ::navigation::Plan& plan, const MapRules& rules) {
  if (plan.state != ::navigation::PlanState::PLANNED)
    return failed_precondition("the plan has no way: {}", plan.reason);
  const auto map = map_at(memory, plan.cost_map);
  if (!map.ok() && map.status().code() == StatusCode::kNotFound)
    return failed_precondition("the plan's map '{}' is not in the memory",
                               plan.cost_map.printable());
  ENGRAM_RETURN_IF_ERROR(map.status());
  return check_map(memory, *map, rules).with_context("the plan is stale");
}

Result<CostMap> map_at(Memory& memory, const ltm::MemoryId& link) {
  ENGRAM_ASSIGN_OR_RETURN(const idf::Data value, value_at(memory, link));
  return CostMap::from_data(value, link);
}

Result<idf::Data> value_at(Memory& memory, const ltm::MemoryId& link) {
  if (!link.has_entity() || !link.time())
    return invalid_argument("'{}' names no snapshot", link.printable());
  ENGRAM_ASSIGN_OR_RETURN(
      const ltm::QueryResult found,
      memory.query(ltm::Query::of_entity(link.entity(), ltm::select::At{*link.time()})));
  const ltm::SnapshotResult* snapshot = found.find_snapshot(link.entity().at(*link.time()));
  const ltm::InstanceResult* instance =
      snapshot == nullptr ? nullptr : snapshot->find(link.index().value_or(0));
  // Where the memory has no such moment it may answer with a prediction of it.
  if (instance == nullptr || snapshot->source == ltm::Source::kPredicted)
    return not_found("the memory has no '{}'", link.printable());
  return instance->data;
}

}  // namespace engram::navigation
