// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>

#include "ltm/memory/memory_id.h"
#include "server/navigation/planar_pose.h"

namespace engram::navigation {

/// What stands in the way of a robot: the outline of a thing on the floor.
struct Obstacle {
  enum class Shape : uint8_t { kBox, kCylinder };

  ltm::MemoryId snapshot;  ///< What says where it is.
  std::string name;
  Shape shape = Shape::kBox;
  PlanarPose pose_world_obstacle;  ///< Its middle.
  /// Along its x and y axes; a cylinder has its diameter in both. Unit: m.
  Eigen::Vector2d size_m = Eigen::Vector2d::Zero();
  double max_speed_m_s = 0;  ///< How fast it may move; 0: it stays.

  /// The distance of a point from the outline; 0 inside. Unit: m.
  [[nodiscard]] double distance_m(const Eigen::Vector2d& point) const;

  /// Whether it and the square around `centre`, along the axes of `turned_rad`, have a point in
  /// common.
  [[nodiscard]] bool touches_square(const Eigen::Vector2d& centre, double side_m,
                                    double turned_rad) const;

  /// The radius of the circle around its middle that holds all of it. Unit: m.
  [[nodiscard]] double outer_radius_m() const;

  /// Whether `other` blocks the same floor, to within 1 mm and a thousandth of a radian.
  [[nodiscard]] bool is_at(const Obstacle& other) const;
};

}  // namespace engram::navigation
