// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: where joints have to be for a hand or the head to be somewhere.

#include "datasets/kitchen/world.h"

namespace engram::datasets::kitchen {

/// Kinematics of the robot alone, apart from what the world does.
///
/// Threading: one thread. The world outlives it.
class Kinematics {
 public:
  explicit Kinematics(const World& world);

  struct Answer {
    RobotVector pose;
    double error_m = 0;  ///< From the target to where the hand would be.
  };

  /// Moves the torso and an arm from `from` until the hand is at a pose; where it cannot be quite
  /// so, its place counts more than how it is turned.
  /// Source: Buss, "Introduction to inverse kinematics", 2004: damped least squares, with a pull
  /// to the resting pose where joints are free.
  [[nodiscard]] Answer solve(const RobotVector& from, Side side, const Pose& pose_world_hand);

  /// Angles of the neck, yaw and pitch, that point the cameras at a point. Frame: world.
  [[nodiscard]] std::pair<double, double> look_at(const RobotVector& robot,
                                                  const Eigen::Vector3d& point);

 private:
  void set(const RobotVector& robot);

  const World& world_;
  State state_;
  std::vector<mjtNum> jacobian_;
};

/// How a hand holds a thing. Frame: poses of the hand in the thing's, whose x axis the hand is
/// parallel to.
struct Grasp {
  Pose pose_thing_hand = Pose::Identity();
  double width_m = 0;  ///< Between thumb and fingers.
};

/// The grasp of a hand that comes along a heading, at the thing as it stands. Boxes are grasped
/// across, whatever is round as it comes.
[[nodiscard]] Grasp grasp_of(const ThingClass& type, const Pose& pose_world_thing, Side side,
                             double heading_rad);

}  // namespace engram::datasets::kitchen
