// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <span>

// Private to this room: rotations as a value holds them, and the turn from one to another.

namespace engram::ltm {

/// How the elements of a member say a rotation.
enum class RotationForm : uint8_t {
  kQuaternion,  ///< [4]: w, x, y, z.
  kMatrix,      ///< [3, 3], row-major.
  kPose,        ///< [4, 4], row-major: the upper left corner; beside it a position.
};

/// The rotation that elements say, of length one; nothing where they are none within 0.001 or, of a
/// pose, the last row is not 0, 0, 0, 1. Shape: as many elements as the form has (checked).
[[nodiscard]] std::optional<Eigen::Quaterniond> rotation_of(RotationForm form,
                                                            std::span<const double> elements);

/// Writes a rotation over that of `elements`; a pose keeps its position.
void write_rotation(RotationForm form, const Eigen::Quaterniond& rotation,
                    std::span<double> elements);

/// Axis times angle of what comes before `from` to make it `to`, by the shorter way. Unit: rad.
[[nodiscard]] Eigen::Vector3d turn_between(const Eigen::Quaterniond& from,
                                           const Eigen::Quaterniond& to);

/// What turn_between() tells, turned again; any angle. The sign goes on without a jump.
[[nodiscard]] Eigen::Quaterniond turned(const Eigen::Quaterniond& from,
                                        const Eigen::Vector3d& turn_rad);

}  // namespace engram::ltm
