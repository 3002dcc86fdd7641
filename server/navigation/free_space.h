// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "server/navigation/cost_map.h"

namespace engram::navigation {

/// Which parts of a map hang together for the middle of a robot.
///
/// Two cells hang together where they share a side and both are passable.
/// Threading: immutable.
class FreeSpace {
 public:
  /// Cells are passable below `blocked_from`. Around the points of `near`, up to `near_m`, they are
  /// so below kInscribedCost, because a robot has to start and end in narrow places as well.
  FreeSpace(const CostMap& map, uint8_t blocked_from = kInscribedCost,
            const std::vector<Eigen::Vector2d>& near = {}, double near_m = 0);

  [[nodiscard]] bool is_passable(const Eigen::Vector2d& point) const { return part_of(point) > 0; }

  /// Whether all cells that a straight line crosses are passable.
  [[nodiscard]] bool is_passable(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const;

  /// Equal for points that hang together; 0 for those that are blocked or not on the map.
  [[nodiscard]] int part_of(const Eigen::Vector2d& point) const;

  /// The middle of the passable cell next to a point, that the robot reaches from there in a
  /// straight line over no obstacle; the point itself where it is passable. Nothing where there is
  /// none within `max_m`, and where the point lies in an obstacle.
  [[nodiscard]] std::optional<Eigen::Vector2d> way_out(const Eigen::Vector2d& point,
                                                       double max_m) const;

  /// How far the farthest cell of a part is from a point. Unit: m.
  [[nodiscard]] double extent_m(int part, const Eigen::Vector2d& from) const;

  /// What keeps a part from going on: the obstacles at its border, the next to `from` first.
  [[nodiscard]] std::vector<Obstacle> around(int part, const Eigen::Vector2d& from) const;

  /// The obstacles that the robot touches at a point, or would with its clearance, the next first.
  [[nodiscard]] std::vector<Obstacle> touched_at(const Eigen::Vector2d& point) const;

  [[nodiscard]] const CostMap& map() const { return map_; }

 private:
  /// How near an obstacle is where it blocks a cell.
  [[nodiscard]] double blocked_m(const Obstacle& obstacle) const;

  const CostMap& map_;
  cv::Mat parts_;  ///< CV_32SC1.
};

/// Calls `visit` for each cell that a straight line crosses, until it returns false. Returns
/// whether it never did.
template <typename Visit>
bool visit_cells(const GridFrame& frame, const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                 Visit visit) {
  const Eigen::Vector2d a = frame.pose_world_map.inward(from) / frame.resolution_m;
  const Eigen::Vector2d way = frame.pose_world_map.inward(to) / frame.resolution_m - a;
  cv::Point cell = frame.cell_of(from);
  const cv::Point end = frame.cell_of(to);
  // From border to border: the share of the way at which the next column or row begins.
  const cv::Point step(way.x() < 0 ? -1 : 1, way.y() < 0 ? -1 : 1);
  const auto share = [](double border, double begin, double length) {
    return length == 0 ? 2 : (border - begin) / length;
  };
  double next_x = share(cell.x + (step.x > 0 ? 1 : 0), a.x(), way.x());
  double next_y = share(cell.y + (step.y > 0 ? 1 : 0), a.y(), way.y());
  // Rounding may put the end beside the line, so the number of steps is what ends the walk.
  for (int left = std::abs(end.x - cell.x) + std::abs(end.y - cell.y); left >= 0; --left) {
    if (!visit(cell)) return false;
    if (next_x < next_y) {
      cell.x += step.x;
      next_x += std::abs(share(1, 0, way.x()));
    } else {
      cell.y += step.y;
      next_y += std::abs(share(1, 0, way.y()));
    }
  }
  return true;
}

}  // namespace engram::navigation
