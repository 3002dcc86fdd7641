// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/movable_places.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "datasets/kitchen/entities.h"

namespace engram::datasets::kitchen {

namespace {

struct Rectangle {
  std::string_view name;
  double min_x, min_y, max_x, max_y;
};

// Frame: world. Unit: m. As room_model.cpp builds it.
constexpr Rectangle kRoom{"the room", -2.90, -2.40, 2.60, 1.86};
constexpr std::array<Rectangle, 3> kFurniture{{
    {"the counter", -2.40, 1.26, 1.64, 1.90},
    {"the fridge", 1.64, 1.20, 2.26, 1.90},
    {"the table", -1.925, -0.65, -1.175, 0.85},
}};

}  // namespace

Pose place_away(size_t movable) {
  const ThingClass& type = movable_classes()[movable];
  return standing_movable(type, 6.0, movable == 0 ? -1.0 : 1.0, 0);
}

bool is_away(const Pose& pose) {
  return pose.translation().x() > kRoom.max_x + 1;
}

bool is_movable(const ltm::MemoryId& object) {
  return std::ranges::any_of(
      movable_classes(), [&](const ThingClass& type) { return entities::object(type) == object; });
}

Pose standing_movable(const ThingClass& type, double x_m, double y_m, double heading_rad) {
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::AngleAxisd(heading_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  pose.translation() = Eigen::Vector3d(x_m, y_m, 0.5 * type.size_m.z());
  return pose;
}

double distance_m(const ThingClass& type, const Pose& pose, const Eigen::Vector2d& point) {
  const Eigen::Vector3d own =
      pose.inverse() * Eigen::Vector3d(point.x(), point.y(), pose.translation().z());
  if (type.shape != Shape::kBox) return std::max(0.0, own.head<2>().norm() - 0.5 * type.size_m.x());
  const Eigen::Vector2d beyond =
      (own.head<2>().cwiseAbs() - 0.5 * type.size_m.head<2>()).cwiseMax(0.0);
  return beyond.norm();
}

Status check_room_for(const ThingClass& type, const Pose& pose) {
  const double x = pose.translation().x();
  const double y = pose.translation().y();
  const double radius = 0.5 * type.size_m.x();
  if (x - radius < kRoom.min_x || x + radius > kRoom.max_x || y - radius < kRoom.min_y ||
      y + radius > kRoom.max_y)
    return invalid_argument(
        "the {} has no place at {:g},{:g}: needs x from {:g} to {:g} and y from {:g} to {:g}",
        type.name, x, y, kRoom.min_x + radius, kRoom.max_x - radius, kRoom.min_y + radius,
        kRoom.max_y - radius);
  for (const Rectangle& one : kFurniture) {
    const double away_x = std::max({one.min_x - x, x - one.max_x, 0.0});
    const double away_y = std::max({one.min_y - y, y - one.max_y, 0.0});
    if (std::hypot(away_x, away_y) < radius)
      return invalid_argument("the {} has no place at {:g},{:g}: {} is there", type.name, x, y,
                              one.name);
  }
  return {};
}

}  // namespace engram::datasets::kitchen
