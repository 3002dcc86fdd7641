// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/locations.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "ltm/core/config.h"
#include "ltm/core/log.h"
#include "server/navigation/thing_members.h"

namespace engram::navigation {

namespace {

std::string plain_name(std::string_view name) {
  std::string plain;
  for (const char c : name) {
    if (c == '_')
      plain += ' ';
    else
      plain += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return plain;
}

/// "chair" of "chair 1".
std::string without_number(const std::string& plain) {
  size_t end = plain.size();
  while (end > 0 && plain[end - 1] >= '0' && plain[end - 1] <= '9') --end;
  const bool has_number = end < plain.size() && end > 1 && plain[end - 1] == ' ';
  return has_number ? plain.substr(0, end - 1) : plain;
}

struct KnownLocation {
  ltm::MemoryId id;
  ::navigation::Location location;
};

/// The last snapshots of what a query names; none where nothing matches.
Result<std::vector<std::pair<ltm::MemoryId, idf::Data>>> last_of(Memory& memory,
                                                                 std::string_view names) {
  std::vector<std::pair<ltm::MemoryId, idf::Data>> last;
  if (names.empty()) return last;
  const auto found = memory.query(names);
  if (!found.ok() && found.status().code() == StatusCode::kNotFound) return last;
  ENGRAM_RETURN_IF_ERROR(found.status());
  for (const ltm::EntityResult* entity : found->entities())
    if (!entity->snapshots.empty() && !entity->snapshots.back().instances.empty())
      last.emplace_back(entity->id.at(entity->snapshots.back().time).instance(0),
                        entity->snapshots.back().instances.front().data);
  return last;
}

Result<std::vector<KnownLocation>> known_locations(Memory& memory) {
  ENGRAM_ASSIGN_OR_RETURN(const auto last, last_of(memory, "Navigation/Location/.*/.*"));
  std::vector<KnownLocation> known;
  for (const auto& [id, data] : last) {
    auto location = ::navigation::Location::from_idf(data);
    // One that is malformed must not keep the robot from going anywhere else.
    if (!location.ok()) {
      // A drive looks twice a second.
      log::debug("navigation: location '{}' is no place: {}", id.printable(),
                 location.status().message());
      continue;
    }
    known.push_back({id, *std::move(location)});
  }
  return known;
}

bool is_called(const ::navigation::Location& location, const std::string& plain) {
  return plain_name(location.name) == plain ||
         std::any_of(location.aliases.begin(), location.aliases.end(),
                     [&](const std::string& alias) { return plain_name(alias) == plain; });
}

/// Where a thing is, by the first member that is a pose of those in which things of the map have
/// it.
std::optional<PlanarPose> pose_of_thing(const idf::Data& data, const MapRules& rules) {
  for (const ObstacleSource& source : rules.sources)
    if (const auto pose = pose_in(data, source.pose_member); pose.ok())
      return PlanarPose::of(*pose);
  return {};
}

/// What may stand on furniture.
std::string names_of_things(const MapRules& rules) {
  std::string names;
  for (const ObstacleSource& source : rules.sources)
    if (!source.is_surface) names += (names.empty() ? "" : " ; ") + source.names;
  return names;
}

Result<NamedGoal> goal_of_location(Memory& memory, const KnownLocation& known,
                                   const MapRules& rules) {
  const ::navigation::Location& location = known.location;
  NamedGoal goal{location.name, known.id, {}};
  if (location.pose_object_location && location.object.has_entity()) {
    const auto inner = PlanarPose::from_array(*location.pose_object_location);
    ENGRAM_ASSIGN_OR_RETURN(
        const auto last,
        last_of(
            memory,
            ltm::Query::of_entity(location.object.entity(), ltm::select::Latest{}).to_string()));
    const auto outer = last.empty() ? std::nullopt : pose_of_thing(last.front().second, rules);
    if (!inner || !outer)
      return invalid_argument("location '{}': where '{}' is, which it is relative to, is not known",
                              location.name, location.object.printable());
    goal.poses.push_back(outer->times(*inner));
    return goal;
  }
  const auto pose = location.pose_world_location
                        ? PlanarPose::from_array(*location.pose_world_location)
                        : std::nullopt;
  if (!pose)
    return invalid_argument(
        "location '{}': has no pose_world_location of 3 finite numbers, and is not relative to an "
        "object",
        location.name);
  goal.poses.push_back(*pose);
  return goal;
}

/// Poses around an outline from which the robot faces it.
std::vector<PlanarPose> poses_beside(const Obstacle& obstacle, const CostMap& map,
                                     const PlanarPose& robot) {
  constexpr double kStepM = 0.15;
  constexpr int kMaxStepsOut = 4;
  std::vector<PlanarPose> poses;
  const PlanarPose& middle = obstacle.pose_world_obstacle;
  const Eigen::Vector2d half = obstacle.size_m / 2;
  for (int out = 0; out < kMaxStepsOut; ++out) {
    const double gap = map.inscribed_m + 1.5 * map.frame.resolution_m + out * kStepM;
    std::vector<PlanarPose> ring;
    const auto add = [&](double x, double y, double facing) {
      ring.push_back(middle.times({x, y, facing}));
    };
    constexpr double kTurn = std::numbers::pi / 2;
    if (obstacle.shape == Obstacle::Shape::kCylinder) {
      constexpr int kDirections = 16;
      for (int i = 0; i < kDirections; ++i) {
        const double angle = 2 * std::numbers::pi * i / kDirections;
        const double far = half.x() + gap;
        add(far * std::cos(angle), far * std::sin(angle), angle + 2 * kTurn);
      }
    } else {
      for (const double along : {0.0, -0.5, 0.5, -0.9, 0.9}) {
        add(-half.x() - gap, along * half.y(), 0);
        add(half.x() + gap, along * half.y(), 2 * kTurn);
        add(along * half.x(), -half.y() - gap, kTurn);
        add(along * half.x(), half.y() + gap, -kTurn);
      }
    }
    const bool has_front = obstacle.shape == Obstacle::Shape::kBox && obstacle.max_speed_m_s == 0;
    std::stable_sort(ring.begin(), ring.end(), [&](const PlanarPose& a, const PlanarPose& b) {
      const auto is_before = [&](const PlanarPose& pose) {
        return has_front && middle.inward(pose.position()).x() < -half.x();
      };
      if (is_before(a) != is_before(b)) return is_before(a);
      return (a.position() - robot.position()).norm() < (b.position() - robot.position()).norm();
    });
    poses.insert(poses.end(), ring.begin(), ring.end());
  }
  return poses;
}

/// The obstacle next to the robot for which `fits` is true.
template <typename Fits>
const Obstacle* next_obstacle(const CostMap& map, const PlanarPose& robot, Fits fits) {
  const Obstacle* next = nullptr;
  for (const Obstacle& obstacle : map.obstacles)
    if (fits(obstacle) && (next == nullptr || obstacle.distance_m(robot.position()) <
                                                  next->distance_m(robot.position())))
      next = &obstacle;
  return next;
}

Status unknown_location(const std::string& name, const std::set<std::string>& known) {
  if (known.empty())
    return not_found("location '{}': the memory has no locations and no objects", name);
  const std::vector<std::string> names(known.begin(), known.end());
  const auto closest = closest_word(plain_name(name), names);
  constexpr size_t kNamed = 8;
  std::string list;
  for (size_t i = 0; i < std::min(names.size(), kNamed); ++i)
    list += (i == 0 ? "" : ", ") + names[i];
  if (names.size() > kNamed) list += fmt::format(" and {} more", names.size() - kNamed);
  return not_found("location '{}': unknown{}; there are {}", name,
                   closest ? fmt::format(", did you mean '{}'", *closest) : std::string(), list);
}

}  // namespace

Result<ltm::MemoryId> location_entity(const std::string& provider, const std::string& name) {
  return ltm::MemoryId::from_names({"Navigation", "Location", provider, name});
}

Status commit_location(Memory& memory, const std::string& provider,
                       const ::navigation::Location& location, Time time) {
  ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId entity, location_entity(provider, location.name));
  const bool is_relative = location.pose_object_location && location.object.has_entity();
  if (!is_relative && !location.pose_world_location)
    return invalid_argument(
        "location '{}': needs a pose_world_location, or an object and a pose_object_location",
        location.name);
  for (const auto* pose : {&location.pose_world_location, &location.pose_object_location})
    if (*pose && !PlanarPose::from_array(**pose))
      return invalid_argument("location '{}': a pose needs 3 finite numbers", location.name);
  ltm::Instance instance{location.to_idf(), {}};
  instance.metadata.created = time;
  instance.metadata.provider = provider;
  return memory.commit({{{entity, time, {std::move(instance)}}}});
}

Result<NamedGoal> find_goal(Memory& memory, const MapRules& rules, const std::string& name,
                            const CostMap& map, const PlanarPose& robot) {
  const std::string plain = plain_name(name);
  ENGRAM_ASSIGN_OR_RETURN(const std::vector<KnownLocation> locations, known_locations(memory));
  for (const KnownLocation& known : locations)
    if (is_called(known.location, plain)) return goal_of_location(memory, known, rules);
  const Obstacle* found = next_obstacle(
      map, robot, [&](const Obstacle& obstacle) { return plain_name(obstacle.name) == plain; });
  if (found == nullptr)
    found = next_obstacle(map, robot, [&](const Obstacle& obstacle) {
      return without_number(plain_name(obstacle.name)) == plain;
    });
  if (found != nullptr)
    return NamedGoal{found->name, found->snapshot, poses_beside(*found, map, robot)};
  // What stands on furniture is no obstacle of its own; the robot goes to the furniture.
  std::set<std::string> names;
  ENGRAM_ASSIGN_OR_RETURN(const auto things, last_of(memory, names_of_things(rules)));
  for (const auto& [id, data] : things) {
    const std::string called = plain_name(id.names().back());
    names.insert(called);
    if (called != plain && without_number(called) != plain) continue;
    const auto at = pose_of_thing(data, rules);
    if (!at) continue;
    const Obstacle* below = next_obstacle(map, robot, [&](const Obstacle& obstacle) {
      return obstacle.distance_m(at->position()) <= 0;
    });
    if (below == nullptr) continue;
    return NamedGoal{id.names().back(), id, poses_beside(*below, map, *at)};
  }
  for (const KnownLocation& known : locations) {
    names.insert(plain_name(known.location.name));
    for (const std::string& alias : known.location.aliases) names.insert(plain_name(alias));
  }
  for (const Obstacle& obstacle : map.obstacles) names.insert(plain_name(obstacle.name));
  return unknown_location(name, names);
}

}  // namespace engram::navigation
