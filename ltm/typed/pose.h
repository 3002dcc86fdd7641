// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <concepts>

namespace engram::typed {

/// A position and an orientation.
///
/// It is two members and no Eigen::Isometry3: a rotation that is converted to a matrix and back
/// changes in its last bits, so the value read would differ from the value written.
/// Unit: m for the position.
/// Frame: `pose_world_camera` transforms camera coordinates to world:
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
