// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <span>

// Private to this room: rotations as a value holds them, and the turn from one to another.

namespace engram::ltm {

/// How the elements of a member encode a rotation.
enum class RotationForm : uint8_t {
  kQuaternion,  ///< [4]: w, x, y, z.
  kMatrix,      ///< [3, 3], row-major.
  kPose,        ///< [4, 4], row-major: rotation in the upper left 3x3, position in column 4.
};

/// Reads a rotation as a unit quaternion. Nothing if the elements are no rotation within 0.001 or,
/// for a pose, the last row is not 0, 0, 0, 1. Shape: as many elements as the form has (checked).
[[nodiscard]] std::optional<Eigen::Quaterniond> rotation_of(RotationForm form,
                                                            std::span<const double> elements);

/// Writes a rotation over the one in `elements`; a pose keeps its position.
void write_rotation(RotationForm form, const Eigen::Quaterniond& rotation,
                    std::span<double> elements);

/// The rotation vector (axis times angle) of the rotation that, applied after `from`, gives `to`,
/// the shorter way round. Unit: rad.
[[nodiscard]] Eigen::Vector3d turn_between(const Eigen::Quaterniond& from,
                                           const Eigen::Quaterniond& to);

/// Applies a rotation vector as turn_between() returns it, of any angle. The sign of the quaternion
/// continues without a jump.
[[nodiscard]] Eigen::Quaterniond turned(const Eigen::Quaterniond& from,
                                        const Eigen::Vector3d& turn_rad);

}  // namespace engram::ltm
