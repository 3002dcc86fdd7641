// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: where the robot and its hands are to be for what it does.

#include "datasets/kitchen/world.h"

namespace engram::datasets::kitchen {

/// How far a hand may be from its grasp to hold something.
inline constexpr double kHoldsWithin_m = 0.03;

/// Platform (x, y, heading) before a surface, so that a point of it lies so far to its left.
[[nodiscard]] Eigen::Vector3d standing_at(const Eigen::Vector3d& point, Surface surface,
                                          double left_m);

/// Where a hand waits before it goes to `at`: back along the hand, and away with its palm.
[[nodiscard]] Pose before(const Pose& at, Side side);

/// Where a hand holds something while the platform drives. `robot`: where it is.
[[nodiscard]] Pose carrying_pose(const RobotVector& robot, Side side, const Pose& pose_world_hand);

/// A thing that stands upright on a point, turned so that the hand that holds it comes along a
/// heading.
[[nodiscard]] Pose standing_thing(const Eigen::Vector3d& foot, const ThingClass& type,
                                  const Pose& pose_thing_hand, double heading_rad);

[[nodiscard]] bool is_upright(const Pose& pose);

}  // namespace engram::datasets::kitchen
