// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the objects in the kitchen.

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <string_view>

namespace engram::datasets::kitchen {

enum class Shape { kBox, kBottle, kCan, kMug };

/// A kind of object. Its origin is its middle and z points up. A box is grasped across its y axis.
struct ThingClass {
  std::string_view name;
  std::string_view spoken_name;
  Shape shape;
  Eigen::Vector3d size_m;
  double mass_kg;
  double grasp_height_m;      ///< Height of the grasp above the underside.
  std::array<int, 3> colour;  ///< RGB colour of its label or side.
  std::array<int, 3> accent;  ///< RGB colour of the text on it.
  std::string_view label;
};

/// Returns all kinds. A recording has some of them, and at most one object of each.
[[nodiscard]] std::span<const ThingClass> all_thing_classes();

/// Returns what can be moved about in a live kitchen: a chair and a person, in this order. Nobody
/// grasps them.
[[nodiscard]] std::span<const ThingClass> movable_classes();

/// Returns the kind of this name, movable or not; null if there is none.
[[nodiscard]] const ThingClass* class_named(std::string_view name);

/// A surface that things stand on. The x axis of its frame points away from a person in front of
/// it.
struct SurfacePlace {
  std::string_view name;
  std::string_view spoken_name;
  Eigen::Vector3d top_m;  ///< The middle of its top. Frame: world.
  double heading_rad;     ///< The heading of a person in front of it.
  double depth_m;
  double width_m;
  double row_m;        ///< Distance from the near edge to the row of things.
  double row_shift_m;  ///< Shift along the y axis, to the left of a person in front of it.
};

enum class Surface { kCounter, kTable };

[[nodiscard]] const SurfacePlace& place_of(Surface surface);
[[nodiscard]] inline Surface other(Surface surface) {
  return surface == Surface::kCounter ? Surface::kTable : Surface::kCounter;
}

/// Number of slots in the row of a surface, counted from the left.
inline constexpr int kSlots = 6;
inline constexpr double kSlotDistance_m = 0.21;

/// Returns the point of the top at which a thing in a slot stands. Frame: world.
[[nodiscard]] Eigen::Vector3d slot_point(Surface surface, int slot);

/// Returns the surface that a point is above or at most 10 cm beside; empty if there is none.
/// Frame: world.
[[nodiscard]] std::optional<Surface> surface_below(const Eigen::Vector3d& point);

/// Return unit vectors. Frame: world.
[[nodiscard]] Eigen::Vector3d ahead(const SurfacePlace& place);
[[nodiscard]] Eigen::Vector3d leftward(const SurfacePlace& place);

}  // namespace engram::datasets::kitchen
