// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/path_planner.h"

#include <cmath>

#include "server/navigation/free_space.h"
#include "server/navigation/path_search.h"

namespace engram::navigation {

namespace {

/// "chair_1 and table", or what else is there where no obstacle is known.
std::string named_or_border(const std::vector<Obstacle>& obstacles) {
  return obstacles.empty() ? "walls, unknown floor or the border of the map" : names_of(obstacles);
}

std::string printed(const PlanarPose& pose) {
  return fmt::format("({:.2f}, {:.2f})", pose.x_m, pose.y_m);
}

FoundPath no_path(std::string reason, std::vector<Obstacle> blocked_by) {
  FoundPath found;
  found.reason = std::move(reason);
  found.blocked_by = std::move(blocked_by);
  return found;
}

FoundPath path_through(const std::vector<Eigen::Vector2d>& corners, const PlanarPose& start,
                       const PlanarPose& goal) {
  FoundPath found;
  found.path.push_back(start);
  for (const Eigen::Vector2d& corner : corners) {
    const Eigen::Vector2d way = corner - found.path.back().position();
    // The first corner is where the robot is, and so may be the goal.
    if (way.norm() < 1e-9) continue;
    found.length_m += way.norm();
    found.path.push_back({corner.x(), corner.y(), std::atan2(way.y(), way.x())});
  }
  if (found.path.size() == 1)
    found.path.push_back(goal);
  else
    found.path.back().heading_rad = goal.heading_rad;
  return found;
}

/// Why two points do not hang together, in words.
FoundPath closed_off(const FreeSpace& space, const PlanarPose& start, int start_part,
                     const PlanarPose& goal, int goal_part, double trapped_m) {
  if (space.extent_m(start_part, start.position()) < trapped_m) {
    std::vector<Obstacle> around = space.around(start_part, start.position());
    FoundPath found = no_path(
        fmt::format("the robot at {} is surrounded by {}", printed(start), named_or_border(around)),
        around);
    found.is_trapped = true;
    return found;
  }
  std::vector<Obstacle> around = space.around(goal_part, goal.position());
  return no_path(fmt::format("no way leads from {} to {}, which {} closes off", printed(start),
                             printed(goal), named_or_border(around)),
                 around);
}

}  // namespace

Status PathPlanner::Options::validate() const {
  if (seed == 0) return invalid_argument("planner: the seed is 0, needs more than 0");
  if (tries == 0) return invalid_argument("planner: makes 0 tries, needs more than 0");
  if (time_limit <= Duration::zero())
    return invalid_argument("planner: the time limit is {}, needs more than 0",
                            to_string(time_limit));
  if (!(way_out_m >= 0 && trapped_m > 0))
    return invalid_argument("planner: way_out {} m and trapped {} m, needs at least 0 and more",
                            way_out_m, trapped_m);
  return {};
}

Result<PathPlanner> PathPlanner::create(const Options& options) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  return PathPlanner(options);
}

FoundPath PathPlanner::plan(const CostMap& map, const PlanarPose& start,
                            const PlanarPose& goal) const {
  const FreeSpace all(map);
  if (!all.is_passable(goal.position())) {
    std::vector<Obstacle> touched = all.touched_at(goal.position());
    return no_path(fmt::format("the goal {} is not free: the robot would be too near to {}",
                               printed(goal), named_or_border(touched)),
                   touched);
  }
  const auto out = all.way_out(start.position(), options_.way_out_m);
  if (!out) {
    std::vector<Obstacle> touched = all.touched_at(start.position());
    const bool is_inside = map.cost_at(start.position()) >= kLethalCost;
    const char* what = is_inside ? "in collision with" : "not free: the robot is enclosed by";
    FoundPath found = no_path(
        fmt::format("the start {} is {} {}", printed(start), what, named_or_border(touched)),
        touched);
    found.is_trapped = !is_inside;
    return found;
  }
  const int start_part = all.part_of(*out);
  const int goal_part = all.part_of(goal.position());
  if (start_part != goal_part)
    return closed_off(all, start, start_part, goal, goal_part, options_.trapped_m);

  const SearchLimits limits{options_.seed, options_.tries, options_.time_limit};
  // First where there is room, then where there is less: a way that hugs furniture is driven
  // slowly.
  for (const uint8_t below : options_.preferred_below) {
    constexpr double kNearEndsM = 0.7;
    const FreeSpace roomy(map, below, {*out, goal.position()}, kNearEndsM);
    const int part = roomy.part_of(*out);
    if (part == 0 || part != roomy.part_of(goal.position())) continue;
    if (const auto corners = search_path(roomy, *out, goal.position(), limits))
      return path_through(*corners, start, goal);
  }
  if (const auto corners = search_path(all, *out, goal.position(), limits))
    return path_through(*corners, start, goal);
  return no_path(fmt::format("a way from {} to {} exists, but was not found within {}",
                             printed(start), printed(goal), to_string(options_.time_limit)),
                 {});
}

}  // namespace engram::navigation
