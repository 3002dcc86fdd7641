// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <concepts>

namespace engram::typed {

/// Where something is and how it is turned.
///
/// Two members and no Eigen::Isometry3: turned into a matrix and back, the numbers of a rotation
/// change in their last bits, and what was read would not be what was written.
/// Unit: m for the position.
/// Frame: `pose_world_camera` takes camera coordinates to world:
/// p_world = orientation * p_camera + position. Hamilton quaternion of norm 1.
template <std::floating_point T>
struct Pose {
  Eigen::Matrix<T, 3, 1> position = Eigen::Matrix<T, 3, 1>::Zero();
  Eigen::Quaternion<T> orientation = Eigen::Quaternion<T>::Identity();

  using Isometry = Eigen::Transform<T, 3, Eigen::Isometry>;

  Pose() = default;
  Pose(const Eigen::Matrix<T, 3, 1>& at, const Eigen::Quaternion<T>& turned)
      : position(at), orientation(turned) {}
  explicit Pose(const Isometry& isometry)
      : position(isometry.translation()), orientation(isometry.linear()) {}

  [[nodiscard]] Isometry isometry() const {
    Isometry result = Isometry::Identity();
    result.linear() = orientation.toRotationMatrix();
    result.translation() = position;
    return result;
  }
};

}  // namespace engram::typed
