// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace engram::encoders {

/// w, x, y, z.
using Quaternion = std::array<double, 4>;
/// Vector part over one plus scalar part: rotations up to half a turn are those of length up to 1.
using RotationParameters = std::array<double, 3>;

// Additions, multiplications, divisions and square roots alone, which are rounded alike on every
// machine: what is decoded is the same everywhere.
// Source: Schaub and Junkins, "Stereographic Orientation Parameters for Attitude Dynamics", 1996.

[[nodiscard]] Quaternion multiply(const Quaternion& a, const Quaternion& b);
[[nodiscard]] Quaternion conjugate(const Quaternion& q);

/// Of length one, w >= 0 (the first that is not zero is positive). Needs a finite one that is not
/// zero.
[[nodiscard]] Quaternion canonical(const Quaternion& q);

/// True where the length is one but for rounding to 32 bits.
[[nodiscard]] bool is_unit(std::span<const double, 4> q);

[[nodiscard]] RotationParameters to_parameters(const Quaternion& q);
[[nodiscard]] Quaternion from_parameters(const RotationParameters& p);

/// Goes on as from `before` to `last`, `eighths` / 8 of the way.
[[nodiscard]] Quaternion extrapolate(const Quaternion& before, const Quaternion& last, int eighths);

/// Angle of the rotation between two. Unit: rad, 0 to pi.
[[nodiscard]] double angle_between_rad(const Quaternion& a, const Quaternion& b);

/// Step of the parameters that keeps the angle within `bound_rad`.
[[nodiscard]] double parameter_step(double bound_rad);

}  // namespace engram::encoders
