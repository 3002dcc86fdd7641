// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: inverse kinematics of the hands and the head.

#include "datasets/kitchen/world.h"

namespace engram::datasets::kitchen {

/// Kinematics of the robot alone, independent of the state of the world.
///
/// Threading: one thread. The world must outlive it.
class Kinematics {
 public:
  explicit Kinematics(const World& world);

  struct Answer {
    RobotVector pose;
    double error_m = 0;  ///< From the target to where the hand would be.
  };

  /// Moves the torso and an arm from `from` until the hand has the given pose. If it cannot, the
  /// position counts more than the orientation.
  /// Source: Buss, "Introduction to inverse kinematics", 2004: damped least squares, with a pull
  /// towards the resting pose where joints are free.
  [[nodiscard]] Answer solve(const RobotVector& from, Side side, const Pose& pose_world_hand);

  /// Returns the angles of the neck, yaw and pitch, that point the cameras at a point. Frame:
  /// world.
  [[nodiscard]] std::pair<double, double> look_at(const RobotVector& robot,
                                                  const Eigen::Vector3d& point);

 private:
  void set(const RobotVector& robot);

  const World& world_;
  State state_;
  std::vector<mjtNum> jacobian_;
};

/// How a hand holds a thing. Frame: the pose of the hand is in the frame of the thing, whose x axis
/// is parallel to the hand.
struct Grasp {
  Pose pose_thing_hand = Pose::Identity();
  double width_m = 0;  ///< Distance between thumb and fingers.
};

/// Returns the grasp of a hand that arrives along a heading, for the thing in its current pose.
/// Boxes are grasped across; round things from any direction.
[[nodiscard]] Grasp grasp_of(const ThingClass& type, const Pose& pose_world_thing, Side side,
                             double heading_rad);

}  // namespace engram::datasets::kitchen
