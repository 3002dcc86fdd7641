// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/choose_path.h"

#include <algorithm>

#include "server/navigation/free_space.h"
#include "server/navigation/locations.h"

namespace engram::navigation {

namespace {

/// A place is kept while one of the places that its name stands for is nearer than this. Beside
/// furniture those are up to 0.4 m apart.
constexpr double kSamePlaceM = 0.4;
/// A location has one place, and is where it was or is not.
constexpr double kMovedM = 0.02;

bool is_near_one(const std::vector<PlanarPose>& poses, const PlanarPose& pose) {
  const double near_m = poses.size() > 1 ? kSamePlaceM : kMovedM;
  return std::any_of(poses.begin(), poses.end(), [&](const PlanarPose& one) {
    return (one.position() - pose.position()).norm() <= near_m;
  });
}

/// Whether an error says that the name stands for no place, and not that the memory failed.
bool is_about_the_name(const Status& status) {
  return status.code() == StatusCode::kNotFound || status.code() == StatusCode::kInvalidArgument;
}

/// What was chosen before, while it is there; else what was asked for.
Result<NamedGoal> find_kept_goal(const PathInputs& inputs, const std::string& name,
                                 const std::optional<KeptGoal>& before) {
  const auto find = [&](const std::string& called) {
    return find_goal(inputs.memory, inputs.rules, called, inputs.map, inputs.robot);
  };
  if (before && !before->name.empty()) {
    auto kept = find(before->name);
    if (kept.ok() || !is_about_the_name(kept.status())) return kept;
  }
  return find(name);
}

/// A way to the first of the places that can be reached.
void choose_among(const std::vector<PlanarPose>& poses, const PathInputs& inputs,
                  const PathPlanner& planner, ChosenPath& chosen) {
  const auto& [memory, rules, map, robot] = inputs;
  const FreeSpace space(map);
  const auto out = space.way_out(robot.position(), planner.options().way_out_m);
  const int part = out ? space.part_of(*out) : 0;
  chosen.goal = poses.front();
  for (const PlanarPose& pose : poses) {
    if (part == 0 || space.part_of(pose.position()) != part) continue;
    chosen.goal = pose;
    chosen.found = planner.plan(map, robot, pose);
    return;
  }
  // None can be reached. That of a free place tells more than that of one that is not free.
  for (const PlanarPose& pose : poses)
    if (space.is_passable(pose.position())) {
      chosen.goal = pose;
      break;
    }
  chosen.found = planner.plan(map, robot, chosen.goal);
  if (poses.size() > 1)
    chosen.found.reason = fmt::format("no free place beside '{}' can be reached: {}", chosen.name,
                                      chosen.found.reason);
}

}  // namespace

Result<ChosenPath> choose_path(const PathInputs& inputs, const PathPlanner& planner,
                               const DriveRequest& request, const std::optional<KeptGoal>& before) {
  ChosenPath chosen;
  chosen.goal = inputs.robot;
  if (request.goal.empty()) {
    if (!request.pose) {
      chosen.found.reason = "the request names no place";
    } else if (!request.pose->is_finite()) {
      chosen.found.reason = "the goal has numbers that are not finite";
    } else {
      chosen.goal = *request.pose;
      chosen.found = planner.plan(inputs.map, inputs.robot, chosen.goal);
    }
    return chosen;
  }
  const auto named = find_kept_goal(inputs, request.goal, before);
  if (!named.ok()) {
    if (!is_about_the_name(named.status())) return named.status();
    chosen.found.reason = named.status().message();
    return chosen;
  }
  chosen.name = named->name;
  chosen.location = named->location;
  std::vector<PlanarPose> poses = named->poses;
  // A location has one place. Of those around a thing that was moved none is the one before.
  if (before && poses.size() > 1 && is_near_one(poses, before->pose))
    poses.insert(poses.begin(), before->pose);
  choose_among(poses, inputs, planner, chosen);
  return chosen;
}

Result<bool> is_goal_near(const PathInputs& inputs, const KeptGoal& goal) {
  const auto named = find_goal(inputs.memory, inputs.rules, goal.name, inputs.map, inputs.robot);
  if (named.ok()) return is_near_one(named->poses, goal.pose);
  if (!is_about_the_name(named.status())) return named.status();
  return false;
}

}  // namespace engram::navigation
