// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace engram::encoders {

/// w, x, y, z.
using Quaternion = std::array<double, 4>;
/// The vector part divided by one plus the scalar part. Rotations of up to half a turn have a
/// length of up to 1.
using RotationParameters = std::array<double, 3>;

// These functions use only additions, multiplications, divisions and square roots, which round in
// the same way on every machine. So decoded values are the same everywhere.
// Source: Schaub and Junkins, "Stereographic Orientation Parameters for Attitude Dynamics", 1996.

[[nodiscard]] Quaternion multiply(const Quaternion& a, const Quaternion& b);
[[nodiscard]] Quaternion conjugate(const Quaternion& q);

/// Scales to length one and turns to w >= 0 (the first part that is not zero is positive). `q` must
/// be finite and not zero.
[[nodiscard]] Quaternion canonical(const Quaternion& q);

/// Whether the length is one up to rounding to 32 bits.
[[nodiscard]] bool is_unit(std::span<const double, 4> q);

[[nodiscard]] RotationParameters to_parameters(const Quaternion& q);
[[nodiscard]] Quaternion from_parameters(const RotationParameters& p);

/// Continues the rotation from `before` to `last` by `eighths` / 8 of it.
[[nodiscard]] Quaternion extrapolate(const Quaternion& before, const Quaternion& last, int eighths);

/// Angle of the rotation between two. Unit: rad, 0 to pi.
[[nodiscard]] double angle_between_rad(const Quaternion& a, const Quaternion& b);

/// Step of the parameters with which rounding keeps the angle within `bound_rad`.
[[nodiscard]] double parameter_step(double bound_rad);

}  // namespace engram::encoders
