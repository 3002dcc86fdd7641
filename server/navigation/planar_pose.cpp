// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/planar_pose.h"

#include <cmath>
#include <numbers>

namespace engram::navigation {

Eigen::Vector2d PlanarPose::outward(const Eigen::Vector2d& point) const {
  const double c = std::cos(heading_rad);
  const double s = std::sin(heading_rad);
  return {x_m + c * point.x() - s * point.y(), y_m + s * point.x() + c * point.y()};
}

Eigen::Vector2d PlanarPose::inward(const Eigen::Vector2d& point) const {
  const double c = std::cos(heading_rad);
  const double s = std::sin(heading_rad);
  const double x = point.x() - x_m;
  const double y = point.y() - y_m;
  return {c * x + s * y, -s * x + c * y};
}

PlanarPose PlanarPose::times(const PlanarPose& inner) const {
  const Eigen::Vector2d at = outward(inner.position());
  return {at.x(), at.y(), wrapped(heading_rad + inner.heading_rad)};
}

bool PlanarPose::is_finite() const {
  return std::isfinite(x_m) && std::isfinite(y_m) && std::isfinite(heading_rad);
}

idf::NdArray PlanarPose::to_array() const {
  return idf::NdArray::take<double>({3}, {x_m, y_m, heading_rad});
}

std::optional<PlanarPose> PlanarPose::from_array(const idf::NdArray& array) {
  if (array.type() != idf::ElementType::kFloat64 || array.shape() != idf::Shape{3}) return {};
  const auto values = array.values<double>();
  const PlanarPose pose{values[0], values[1], values[2]};
  if (!pose.is_finite()) return {};
  return pose;
}

PlanarPose PlanarPose::of(const typed::Pose<double>& pose) {
  const Eigen::Vector3d x_axis = pose.orientation * Eigen::Vector3d::UnitX();
  // A thing that lies on its end has no heading by its x axis; 0.1 is far above rounding.
  if (x_axis.head<2>().norm() > 0.1)
    return {pose.position.x(), pose.position.y(), std::atan2(x_axis.y(), x_axis.x())};
  const Eigen::Vector3d y_axis = pose.orientation * Eigen::Vector3d::UnitY();
  return {pose.position.x(), pose.position.y(),
          wrapped(std::atan2(y_axis.y(), y_axis.x()) - std::numbers::pi / 2)};
}

double wrapped(double angle_rad) {
  const double turned = std::remainder(angle_rad, 2 * std::numbers::pi);
  return turned <= -std::numbers::pi ? turned + 2 * std::numbers::pi : turned;
}

}  // namespace engram::navigation
