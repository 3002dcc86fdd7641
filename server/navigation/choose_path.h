// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: from what was asked for to a way there.

#include <optional>
#include <string>

#include "server/navigation/drive_log.h"
#include "server/navigation/map_rules.h"
#include "server/navigation/path_planner.h"

namespace engram::navigation {

/// What a way is chosen by.
struct PathInputs {
  Memory& memory;
  const MapRules& rules;  ///< Those of the map.
  const CostMap& map;
  PlanarPose robot;
};

/// A way to the best of the places that a goal allows, or why there is none.
struct ChosenPath {
  FoundPath found;
  PlanarPose goal;   ///< Where the robot is, if no place was found.
  std::string name;  ///< As the memory calls what was found by name; empty: none.
  ltm::MemoryId location;
};

/// The goal that a drive goes to since its last plan.
struct KeptGoal {
  PlanarPose pose;
  std::string name;  ///< ChosenPath::name.
};

/// `before` is the goal that was chosen before. A robot that was sent to `chair` stays with the
/// chair that it chose, and does not change its mind at each step of a person: it keeps the place
/// where that is still free and still one beside the thing.
/// Errors: those of the memory. A name that nobody knows and a place that no way leads to are no
/// errors, but reasons.
Result<ChosenPath> choose_path(const PathInputs& inputs, const PathPlanner& planner,
                               const DriveRequest& request,
                               const std::optional<KeptGoal>& before = {});

/// Whether one of the places that the name of a goal stands for is still near its pose; false also
/// where the memory knows the name no more.
/// Errors: those of the memory.
Result<bool> is_goal_near(const PathInputs& inputs, const KeptGoal& goal);

}  // namespace engram::navigation
