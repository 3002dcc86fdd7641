// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/map_rules.h"

#include <cmath>

#include "ltm/memory/name_pattern.h"
#include "ltm/memory/query.h"

namespace engram::navigation {

namespace {

Status read_grid(ConfigMap& top, GridFrame& frame) {
  const auto value = top.find("grid");
  if (!value) return {};
  ENGRAM_ASSIGN_OR_RETURN(ConfigMap map, value->map());
  double width = frame.columns * frame.resolution_m;
  double height = frame.rows * frame.resolution_m;
  ENGRAM_RETURN_IF_ERROR(map.read("x", frame.pose_world_map.x_m, &ConfigValue::number));
  ENGRAM_RETURN_IF_ERROR(map.read("y", frame.pose_world_map.y_m, &ConfigValue::number));
  ENGRAM_RETURN_IF_ERROR(
      map.read("heading", frame.pose_world_map.heading_rad, &ConfigValue::number));
  ENGRAM_RETURN_IF_ERROR(map.read("width", width, &ConfigValue::number));
  ENGRAM_RETURN_IF_ERROR(map.read("height", height, &ConfigValue::number));
  ENGRAM_RETURN_IF_ERROR(map.read("resolution", frame.resolution_m, &ConfigValue::number));
  ENGRAM_RETURN_IF_ERROR(map.finish());
  const double columns = std::ceil(width / frame.resolution_m - 1e-9);
  const double rows = std::ceil(height / frame.resolution_m - 1e-9);
  if (!(columns >= 1 && rows >= 1 && columns * rows <= static_cast<double>(GridFrame::kMaxCells)))
    return value->error(
        fmt::format("{} x {} m in cells of {} m are {:.0f} x {:.0f} cells, needs 1 "
                    "to {}",
                    width, height, frame.resolution_m, columns, rows, GridFrame::kMaxCells));
  frame.columns = static_cast<int>(columns);
  frame.rows = static_cast<int>(rows);
  const Status valid = frame.validate();
  return valid.ok() ? valid : value->error(valid);
}

Status read_costs(ConfigMap& top, CostRules& costs) {
  const auto value = top.find("costs");
  if (!value) return {};
  ENGRAM_ASSIGN_OR_RETURN(ConfigMap map, value->map());
  ENGRAM_RETURN_IF_ERROR(map.read("robot_radius", costs.robot_radius_m, &ConfigValue::number));
  ENGRAM_RETURN_IF_ERROR(map.read("clearance", costs.clearance_m, &ConfigValue::number));
  ENGRAM_RETURN_IF_ERROR(
      map.read("inflation_radius", costs.inflation_radius_m, &ConfigValue::number));
  ENGRAM_RETURN_IF_ERROR(map.read("falloff", costs.falloff_per_m, &ConfigValue::number));
  ENGRAM_RETURN_IF_ERROR(map.finish());
  const Status valid = costs.validate();
  return valid.ok() ? valid : value->error(valid);
}

Result<ObstacleSource> read_source(const ConfigValue& value) {
  ENGRAM_ASSIGN_OR_RETURN(ConfigMap map, value.map());
  ObstacleSource source;
  ENGRAM_RETURN_IF_ERROR(map.read("is_surface", source.is_surface, &ConfigValue::boolean));
  if (source.is_surface) source = MapRules::surfaces();
  ENGRAM_RETURN_IF_ERROR(map.read("names", source.names, &ConfigValue::text));
  ENGRAM_RETURN_IF_ERROR(map.read("pose", source.pose_member, &ConfigValue::text));
  ENGRAM_RETURN_IF_ERROR(map.read("class", source.class_member, &ConfigValue::text));
  ENGRAM_RETURN_IF_ERROR(map.read("size", source.size_member, &ConfigValue::text));
  ENGRAM_RETURN_IF_ERROR(map.read("shape", source.shape_member, &ConfigValue::text));
  ENGRAM_RETURN_IF_ERROR(map.read("held", source.held_member, &ConfigValue::text));
  ENGRAM_RETURN_IF_ERROR(map.read("depth", source.depth_member, &ConfigValue::text));
  ENGRAM_RETURN_IF_ERROR(map.read("width", source.width_member, &ConfigValue::text));
  ENGRAM_RETURN_IF_ERROR(map.finish());
  return source;
}

Result<SpeedRule> read_speed(const ConfigValue& value) {
  ENGRAM_ASSIGN_OR_RETURN(ConfigMap map, value.map());
  SpeedRule rule;
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue name, map.require("name"));
  ENGRAM_ASSIGN_OR_RETURN(rule.name, name.text());
  ENGRAM_RETURN_IF_ERROR(map.read("max_speed", rule.max_speed_m_s, &ConfigValue::number));
  ENGRAM_RETURN_IF_ERROR(map.finish());
  return rule;
}

/// Replaces `out` where the key is there.
template <typename T>
Status read_list(ConfigMap& map, std::string_view key, std::vector<T>& out,
                 Result<T> (*one)(const ConfigValue&)) {
  const auto value = map.find(key);
  if (!value) return {};
  ENGRAM_ASSIGN_OR_RETURN(const std::vector<ConfigValue> entries, value->list());
  out.clear();
  for (const ConfigValue& entry : entries) {
    ENGRAM_ASSIGN_OR_RETURN(T read, one(entry));
    out.push_back(std::move(read));
  }
  return {};
}

Result<std::string> read_text(const ConfigValue& value) {
  return value.text();
}

}  // namespace

ObstacleSource MapRules::surfaces() {
  ObstacleSource source;
  source.names = "Objects/Surfaces/.*/.*";
  source.pose_member = "pose_world_surface";
  source.class_member.clear();
  source.held_member.clear();
  source.is_surface = true;
  return source;
}

ltm::MemoryId MapRules::entity() const {
  const auto id = ltm::MemoryId::from_names({"Navigation", "CostMap", provider, map});
  ENGRAM_CHECK(id.ok(), "rules that were not validated: {}", id.status().message());
  return *id;
}

Status MapRules::validate() const {
  ENGRAM_RETURN_IF_ERROR(
      ltm::MemoryId::from_names({"Navigation", "CostMap", provider, map}).status());
  ENGRAM_RETURN_IF_ERROR(frame.validate());
  ENGRAM_RETURN_IF_ERROR(costs.validate());
  if (sources.empty()) return invalid_argument("map: names no sources of obstacles, needs one");
  for (const ObstacleSource& source : sources)
    ENGRAM_RETURN_IF_ERROR(ltm::Query::parse(source.names).status());
  for (const std::string& names : class_names)
    ENGRAM_RETURN_IF_ERROR(ltm::Query::parse(names).status());
  for (const std::string& name : ignored)
    ENGRAM_RETURN_IF_ERROR(ltm::NamePattern::parse(name).status());
  for (const SpeedRule& rule : speeds) {
    ENGRAM_RETURN_IF_ERROR(ltm::NamePattern::parse(rule.name).status());
    if (!(rule.max_speed_m_s >= 0 && rule.max_speed_m_s <= 100))
      return invalid_argument("map: max_speed of '{}' is {} m/s, needs 0 to 100", rule.name,
                              rule.max_speed_m_s);
  }
  if (!(min_height_m >= 0 && min_height_m < max_height_m && max_height_m <= 1000))
    return invalid_argument(
        "map: min_height {} m and max_height {} m, needs 0 <= min < max <= 1000", min_height_m,
        max_height_m);
  if (!(reaction_s >= 0 && reaction_s <= 10))
    return invalid_argument("map: reaction is {} s, needs 0 to 10", reaction_s);
  return {};
}

Result<MapRules> MapRules::read(const ConfigValue& value) {
  ENGRAM_ASSIGN_OR_RETURN(ConfigMap map, value.map());
  MapRules rules;
  ENGRAM_RETURN_IF_ERROR(map.read("provider", rules.provider, &ConfigValue::text));
  ENGRAM_RETURN_IF_ERROR(map.read("map", rules.map, &ConfigValue::text));
  ENGRAM_RETURN_IF_ERROR(read_grid(map, rules.frame));
  ENGRAM_RETURN_IF_ERROR(read_costs(map, rules.costs));
  ENGRAM_RETURN_IF_ERROR(read_list(map, "sources", rules.sources, &read_source));
  ENGRAM_RETURN_IF_ERROR(read_list(map, "classes", rules.class_names, &read_text));
  ENGRAM_RETURN_IF_ERROR(read_list(map, "ignore", rules.ignored, &read_text));
  ENGRAM_RETURN_IF_ERROR(read_list(map, "speeds", rules.speeds, &read_speed));
  ENGRAM_RETURN_IF_ERROR(map.read("min_height", rules.min_height_m, &ConfigValue::number));
  ENGRAM_RETURN_IF_ERROR(map.read("max_height", rules.max_height_m, &ConfigValue::number));
  ENGRAM_RETURN_IF_ERROR(map.read("reaction", rules.reaction_s, &ConfigValue::number));
  ENGRAM_RETURN_IF_ERROR(map.finish());
  const Status valid = rules.validate();
  if (!valid.ok()) return value.error(valid);
  return rules;
}

Result<MapRules> MapRules::read_file(const std::filesystem::path& path) {
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue value, ConfigValue::read_file(path));
  return read(value);
}

}  // namespace engram::navigation
