// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: a quick test of what a camera sees, which knows when it cannot tell.

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "ltm/context/entity_context.h"

namespace engram::ltm {

/// One number for each side of an image: left, right, top and bottom.
using Sides = float __attribute__((vector_size(16)));

/// The planes through a camera and the sides of its image, in coordinates of the camera: what it
/// sees is above all four. u >= -0.5 and z > 0, for instance, is fx x + (cx + 0.5) z >= 0.
///
/// Nothing is divided, so a camera whose orientation is not normalised has the same planes, scaled.
struct LensPlanes {
  Sides x{}, y{}, z{};
  /// A place whose height above a plane is less than this many of its distances |x| + |y| + |z| is
  /// too close to tell; 0 if the lens is an odd one, of which nothing can be told.
  float margin = 0;
};
[[nodiscard]] LensPlanes planes_of(const Intrinsics& lens);

/// The same in the directions of a frame.
struct ViewPlanes {
  Sides x{}, y{}, z{};
  float margin = 0;
  std::array<double, 3> position{};  ///< Of the camera. Unit: m.
};
/// `position` has 3 numbers in m, `orientation` 4: w, x, y, z.
[[nodiscard]] ViewPlanes turned(const LensPlanes& lens, const double* position,
                                const double* orientation);

enum class Glance : uint8_t { kOutside, kInside, kUnsure };

/// Whether all places of a run are in all images of a run, or in none of them. What it is sure of
/// is what the exact computation says of each.
[[nodiscard]] Glance glance_at_run(const LensPlanes& lens, const RunBounds<12>::Bounds& cameras,
                                   const RunBounds<3>::Bounds& places);

/// Whether every lane of a comparison holds.
inline bool holds_for_all(decltype(Sides() > Sides()) comparison) {
  const auto halves = __builtin_bit_cast(std::array<int64_t, 2>, comparison);
  return (halves[0] & halves[1]) == -1;
}

/// Whether a place is in the image, without a division and in floats. What it is sure of is what
/// the exact computation in doubles says, too: planes_of() tells why.
inline Glance glance_at(const ViewPlanes& view, const double* place) {
  constexpr float kMinSize = 1e-15F;
  constexpr float kMaxSize = 1e15F;
  const auto x = static_cast<float>(place[0] - view.position[0]);
  const auto y = static_cast<float>(place[1] - view.position[1]);
  const auto z = static_cast<float>(place[2] - view.position[2]);
  const float size = std::abs(x) + std::abs(y) + std::abs(z);
  const float margin = view.margin * size;
  const Sides heights = view.x * x + view.y * y + view.z * z;
  const bool is_inside = holds_for_all(heights > margin);
  const bool is_close = holds_for_all(heights >= -margin) && !is_inside;
  if (is_close || !(size > kMinSize && size < kMaxSize)) [[unlikely]]
    return Glance::kUnsure;
  return is_inside ? Glance::kInside : Glance::kOutside;
}

}  // namespace engram::ltm
