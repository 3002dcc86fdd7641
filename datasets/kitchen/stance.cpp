// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/stance.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace engram::datasets::kitchen {

namespace {

constexpr double kDistance_m = 0.62;  ///< From the middle of the platform to the target.
constexpr double kBack_m = 0.12;
constexpr double kAside_m = 0.025;
constexpr double kCarryAhead_m = 0.40;
constexpr double kCarryAside_m = 0.20;
constexpr double kMinCarry_z_m = 1.02;
constexpr double kUpright = 0.95;  ///< Minimum z component of the thing's z axis.

}  // namespace

RobotVector starting_pose() {
  RobotVector pose = resting_pose();
  pose.head<kPlatformJoints>() =
      standing_at(slot_point(Surface::kCounter, 2), Surface::kCounter, 0);
  pose.head<2>() += Eigen::Vector2d(-0.25, -0.25);
  pose[2] = 0.75 * std::numbers::pi;
  return pose;
}

Eigen::Vector3d standing_at(const Eigen::Vector3d& point, Surface surface, double left_m) {
  const SurfacePlace& place = place_of(surface);
  Eigen::Vector3d at = point - kDistance_m * ahead(place) - left_m * leftward(place);
  at.z() = place.heading_rad;
  return at;
}

Pose before(const Pose& at, Side side) {
  // The palm faces -sign along the hand's y axis.
  return at * Eigen::Translation3d(-kBack_m, sign_of(side) * kAside_m, 0);
}

Pose carrying_pose(const RobotVector& robot, Side side, const Pose& pose_world_hand) {
  const Eigen::AngleAxisd turn(robot[2], Eigen::Vector3d::UnitZ());
  Pose pose = pose_world_hand;
  pose.translation() =
      turn * Eigen::Vector3d(kCarryAhead_m, sign_of(side) * kCarryAside_m, 0) +
      Eigen::Vector3d(robot[0], robot[1], std::max(pose.translation().z() + 0.04, kMinCarry_z_m));
  return pose;
}

Pose standing_thing(const Eigen::Vector3d& foot, const ThingClass& type,
                    const Pose& pose_thing_hand, double heading_rad) {
  const Eigen::Vector3d along = pose_thing_hand.linear().col(0);
  Pose pose = Pose::Identity();
  pose.linear() =
      Eigen::AngleAxisd(heading_rad - std::atan2(along.y(), along.x()), Eigen::Vector3d::UnitZ())
          .toRotationMatrix();
  pose.translation() = foot + Eigen::Vector3d(0, 0, 0.5 * type.size_m.z() + 0.003);
  return pose;
}

bool is_upright(const Pose& pose) {
  return pose.linear()(2, 2) > kUpright;
}

}  // namespace engram::datasets::kitchen
