// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the dimensions and joints of the humanoid.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace engram::datasets::kitchen {

/// The pose of a part transforms its coordinates to world coordinates.
using Pose = Eigen::Isometry3d;

/// Unit: m. Frame: the parent of each part.
inline constexpr double kTorso_z_m = 0.85;
inline constexpr double kShoulder_y_m = 0.21;
inline constexpr double kNeck_z_m = 0.07;
inline constexpr double kEye_x_m = 0.112;
inline constexpr double kEye_z_m = 0.105;
inline constexpr double kThumbBase_m = 0.088;  ///< Length of the first part of a thumb.
inline constexpr double kPlatformRadius_m = 0.28;

/// The stereo cameras.
inline constexpr double kBaseline_m = 0.07;
inline constexpr double kFieldOfView_rad = 1.05;  ///< Vertical.

inline constexpr int kJoints = 43;
inline constexpr int kPlatformJoints = 3;
inline constexpr int kRobotJoints = kPlatformJoints + kJoints;

enum class Side { kLeft, kRight };

[[nodiscard]] inline std::string_view to_string(Side side) {
  return side == Side::kLeft ? "left" : "right";
}
/// Returns 1 for the left side, -1 for the right.
[[nodiscard]] inline double sign_of(Side side) {
  return side == Side::kLeft ? 1 : -1;
}

/// Positions, velocities, ... of the robot: platform_x, platform_y, platform_yaw, then 43 joints.
using RobotVector = Eigen::Matrix<double, kRobotJoints, 1>;

/// Names in the order of RobotVector; those of the platform come first.
[[nodiscard]] const std::array<std::string, kRobotJoints>& joint_names();

/// The index of a joint in a RobotVector. The name must be one of joint_names() (checked).
[[nodiscard]] int joint_index(std::string_view name);

/// The indices of the seven joints of an arm, starting at the shoulder.
[[nodiscard]] std::vector<int> arm_joints(Side side);

/// The indices of the twelve joints of a hand.
[[nodiscard]] std::vector<int> hand_joints(Side side);

/// Angles of these joints for an open hand, and for a hand around something of this width.
[[nodiscard]] std::vector<double> open_hand();
[[nodiscard]] std::vector<double> hand_around(double width_m);

/// The pose in which the robot waits and drives, with bent arms at its sides.
[[nodiscard]] RobotVector resting_pose();

}  // namespace engram::datasets::kitchen
