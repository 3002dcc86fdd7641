// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: what stands in the kitchen.

#include <Eigen/Core>
#include <array>
#include <span>
#include <string_view>

namespace engram::datasets::kitchen {

enum class Shape { kBox, kBottle, kCan, kMug };

/// A kind of object. Its origin is its middle, z points up; a box is grasped across its y axis.
struct ThingClass {
  std::string_view name;
  std::string_view spoken_name;
  Shape shape;
  Eigen::Vector3d size_m;
  double mass_kg;
  double grasp_height_m;      ///< Above its underside.
  std::array<int, 3> colour;  ///< RGB, of its label or side.
  std::array<int, 3> accent;  ///< RGB, of what is written on it.
  std::string_view label;
};

/// All there are; a recording has some of them, at most one of each.
[[nodiscard]] std::span<const ThingClass> all_thing_classes();

/// What things stand on. The x axis of its frame points away from who stands before it.
struct SurfacePlace {
  std::string_view name;
  std::string_view spoken_name;
  Eigen::Vector3d top_m;  ///< Middle of its top. Frame: world.
  double heading_rad;     ///< Of who stands before it.
  double depth_m;
  double width_m;
  double row_m;        ///< From its near edge to the row of things.
  double row_shift_m;  ///< Along its y axis, to the left of who stands before it.
};

enum class Surface { kCounter, kTable };

[[nodiscard]] const SurfacePlace& place_of(Surface surface);
[[nodiscard]] inline Surface other(Surface surface) {
  return surface == Surface::kCounter ? Surface::kTable : Surface::kCounter;
}

/// Places in the row of a surface, from the left.
inline constexpr int kSlots = 6;
inline constexpr double kSlotDistance_m = 0.21;

/// Where a thing in a slot stands: a point of the top. Frame: world.
[[nodiscard]] Eigen::Vector3d slot_point(Surface surface, int slot);

/// Frame: world.
[[nodiscard]] Eigen::Vector3d ahead(const SurfacePlace& place);
[[nodiscard]] Eigen::Vector3d leftward(const SurfacePlace& place);

}  // namespace engram::datasets::kitchen
