// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: positions of the robot and its hands for each step of a task.

#include "datasets/kitchen/world.h"

namespace engram::datasets::kitchen {

/// The maximum distance of a hand from its grasp at which it holds something.
inline constexpr double kHoldsWithin_m = 0.03;

/// Things start 1 mm above their surface; after so many steps of the world they rest.
inline constexpr int kSettlingSteps = 200;

/// Returns where the robot begins: before the counter, half turned to the table.
[[nodiscard]] RobotVector starting_pose();

/// Returns the platform's (x, y, heading) in front of a surface, with a point of the surface
/// `left_m` to its left.
[[nodiscard]] Eigen::Vector3d standing_at(const Eigen::Vector3d& point, Surface surface,
                                          double left_m);

/// Returns where a hand waits before it goes to `at`: back along the hand, and away from the palm.
[[nodiscard]] Pose before(const Pose& at, Side side);

/// Returns where a hand holds something while the platform drives. `robot`: the robot's position.
[[nodiscard]] Pose carrying_pose(const RobotVector& robot, Side side, const Pose& pose_world_hand);

/// Returns the pose of a thing that stands upright on a point, rotated so that the hand that holds
/// it arrives along a heading.
[[nodiscard]] Pose standing_thing(const Eigen::Vector3d& foot, const ThingClass& type,
                                  const Pose& pose_thing_hand, double heading_rad);

[[nodiscard]] bool is_upright(const Pose& pose);

}  // namespace engram::datasets::kitchen
