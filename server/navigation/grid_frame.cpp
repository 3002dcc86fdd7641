// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/grid_frame.h"

#include <cmath>

namespace engram::navigation {

Status GridFrame::validate() const {
  if (rows <= 0 || columns <= 0)
    return invalid_argument("map: has {} rows and {} columns, needs at least one of each", rows,
                            columns);
  if (int64_t{rows} * columns > kMaxCells)
    return invalid_argument("map: has {} x {} cells, needs at most {}", rows, columns, kMaxCells);
  if (!(resolution_m >= 1e-3 && resolution_m <= 100))
    return invalid_argument("map: has a resolution of {} m, needs 0.001 to 100", resolution_m);
  if (!pose_world_map.is_finite())
    return invalid_argument("map: its origin ({}, {}, {}) has numbers that are not finite",
                            pose_world_map.x_m, pose_world_map.y_m, pose_world_map.heading_rad);
  return {};
}

cv::Point GridFrame::cell_of(const Eigen::Vector2d& point) const {
  constexpr double kLimit = 1e9;
  const Eigen::Vector2d at = pose_world_map.inward(point) / resolution_m;
  if (!(at.cwiseAbs().maxCoeff() < kLimit)) return {-1, -1};
  return {static_cast<int>(std::floor(at.x())), static_cast<int>(std::floor(at.y()))};
}

Eigen::Vector2d GridFrame::middle_of(const cv::Point& cell) const {
  return pose_world_map.outward({(cell.x + 0.5) * resolution_m, (cell.y + 0.5) * resolution_m});
}

cv::Rect GridFrame::cells_around(const Eigen::Vector2d& middle, double radius_m) const {
  constexpr double kLimit = 1e8;
  const Eigen::Vector2d at = pose_world_map.inward(middle) / resolution_m;
  const double reach = radius_m / resolution_m;
  if (!(at.cwiseAbs().maxCoeff() < kLimit) || !(reach < kLimit)) return {};
  // One more cell on each side: a square that only just touches may be on either side of a border.
  const int left = static_cast<int>(std::floor(at.x() - reach)) - 1;
  const int top = static_cast<int>(std::floor(at.y() - reach)) - 1;
  const int right = static_cast<int>(std::floor(at.x() + reach)) + 2;
  const int bottom = static_cast<int>(std::floor(at.y() + reach)) + 2;
  return cv::Rect(left, top, right - left, bottom - top) & whole();
}

cv::Rect widened(const cv::Rect& window, int cells, const cv::Rect& whole) {
  if (window.empty()) return {};
  return cv::Rect(window.x - cells, window.y - cells, window.width + 2 * cells,
                  window.height + 2 * cells) &
         whole;
}

}  // namespace engram::navigation
