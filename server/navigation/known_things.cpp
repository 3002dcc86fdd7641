// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/known_things.h"

#include "ltm/memory/answered_snapshots.h"

namespace engram::navigation {

Status tell_things(Memory& memory, FloorThings& things, std::optional<Time> at) {
  std::string text;
  for (const std::string& names : things.names()) {
    text += (text.empty() ? "" : " ; ") + names;
    if (at) text += " @ at-or-before:" + to_string(*at);
  }
  const auto known = memory.query(text);
  if (!known.ok() && known.status().code() == StatusCode::kNotFound) return {};
  ENGRAM_RETURN_IF_ERROR(known.status());
  for (const ltm::Snapshot& snapshot : ltm::answered_snapshots(*known)) things.take(snapshot);
  return {};
}

Result<FloorThings> known_things(Memory& memory, const MapRules& rules, std::optional<Time> at) {
  ENGRAM_ASSIGN_OR_RETURN(FloorThings things, FloorThings::create(rules));
  ENGRAM_RETURN_IF_ERROR(tell_things(memory, things, at));
  return things;
}

bool apply_changes(FloorThings& things, const MapRules& rules, ObstacleMap& map) {
  const std::vector<FloorThings::Change> changes = things.take_changes();
  for (const FloorThings::Change& change : changes)
    if (change.obstacle)
      map.set(change.entity, *change.obstacle, change.obstacle->max_speed_m_s * rules.reaction_s);
    else
      map.remove(change.entity);
  return !changes.empty();
}

CostMap map_of_things(const FloorThings& things, ObstacleMap& made) {
  CostMap map;
  map.frame = made.frame();
  map.costs = made.update().clone();
  map.inscribed_m = made.rules().inscribed_m();
  map.inflation_m = made.rules().inflation_radius_m;
  map.obstacles = things.obstacles();
  map.left_out = things.left_out();
  return map;
}

Result<CostMap> map_of_known_things(Memory& memory, const MapRules& rules, std::optional<Time> at) {
  ENGRAM_ASSIGN_OR_RETURN(FloorThings things, known_things(memory, rules, at));
  ENGRAM_ASSIGN_OR_RETURN(ObstacleMap made, ObstacleMap::create(rules.frame, rules.costs));
  apply_changes(things, rules, made);
  CostMap map = map_of_things(things, made);
  if (things.newest() != Time{}) map.id = rules.entity().at(things.newest()).instance(0);
  return map;
}

}  // namespace engram::navigation
