// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/obstacle.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace engram::navigation {

namespace {

/// Whether two boxes around their middles, of which the second lies at `offset` and is turned by
/// `turned_rad`, stay apart along an axis of the first.
bool is_apart_along_axes(const Eigen::Vector2d& half, const Eigen::Vector2d& other_half,
                         const Eigen::Vector2d& offset, double turned_rad) {
  const double c = std::abs(std::cos(turned_rad));
  const double s = std::abs(std::sin(turned_rad));
  const Eigen::Vector2d reach{c * other_half.x() + s * other_half.y(),
                              s * other_half.x() + c * other_half.y()};
  return std::abs(offset.x()) > half.x() + reach.x() || std::abs(offset.y()) > half.y() + reach.y();
}

}  // namespace

double Obstacle::distance_m(const Eigen::Vector2d& point) const {
  if (shape == Shape::kCylinder)
    return std::max(0.0, (point - pose_world_obstacle.position()).norm() - size_m.x() / 2);
  const Eigen::Vector2d inside = pose_world_obstacle.inward(point).cwiseAbs() - size_m / 2;
  return inside.cwiseMax(0.0).norm();
}

bool Obstacle::touches_square(const Eigen::Vector2d& centre, double side_m,
                              double turned_rad) const {
  const PlanarPose square{centre.x(), centre.y(), turned_rad};
  const Eigen::Vector2d half_square(side_m / 2, side_m / 2);
  if (shape == Shape::kCylinder) {
    const Eigen::Vector2d middle = square.inward(pose_world_obstacle.position());
    return (middle.cwiseAbs() - half_square).cwiseMax(0.0).norm() <= size_m.x() / 2;
  }
  // Two boxes have no point in common where an axis of one of them separates them.
  const double turned = turned_rad - pose_world_obstacle.heading_rad;
  return !is_apart_along_axes(size_m / 2, half_square, pose_world_obstacle.inward(centre),
                              turned) &&
         !is_apart_along_axes(half_square, size_m / 2,
                              square.inward(pose_world_obstacle.position()), turned);
}

double Obstacle::outer_radius_m() const {
  return shape == Shape::kCylinder ? size_m.x() / 2 : size_m.norm() / 2;
}

bool Obstacle::is_at(const Obstacle& other) const {
  constexpr double kSameM = 1e-3;
  constexpr double kSameRad = 1e-3;
  const PlanarPose& a = pose_world_obstacle;
  const PlanarPose& b = other.pose_world_obstacle;
  const bool is_turned =
      shape == Shape::kBox && std::abs(wrapped(a.heading_rad - b.heading_rad)) > kSameRad;
  return shape == other.shape && (a.position() - b.position()).norm() <= kSameM && !is_turned &&
         (size_m - other.size_m).cwiseAbs().maxCoeff() <= kSameM;
}

}  // namespace engram::navigation
