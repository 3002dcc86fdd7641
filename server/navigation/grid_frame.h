// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/types.hpp>

#include "ltm/core/status.h"
#include "server/navigation/planar_pose.h"

namespace engram::navigation {

/// How the cells of a map lie on the floor.
///
/// Shape: [rows, columns]; cell [0, 0] is at the corner `pose_world_map`, columns go along its x
/// axis and rows along its y axis.
struct GridFrame {
  /// A map of 400 m x 400 m at 5 cm.
  static constexpr int64_t kMaxCells = 64'000'000;

  int rows = 200;
  int columns = 200;
  double resolution_m = 0.05;  ///< The side of a cell.
  PlanarPose pose_world_map{-5, -5, 0};

  /// Errors: kInvalidArgument for sizes or resolutions that are not positive, poses that are not
  /// finite, more than kMaxCells cells, and cells beyond 1 mm to 100 m.
  [[nodiscard]] Status validate() const;

  /// The cell that has a point of the world; it may lie outside of the map (see has). A point too
  /// far away for an integer is taken for (-1, -1). x is the column, y the row.
  [[nodiscard]] cv::Point cell_of(const Eigen::Vector2d& point) const;
  [[nodiscard]] bool has(const cv::Point& cell) const {
    return cell.x >= 0 && cell.y >= 0 && cell.x < columns && cell.y < rows;
  }
  [[nodiscard]] Eigen::Vector2d middle_of(const cv::Point& cell) const;

  [[nodiscard]] cv::Size size() const { return {columns, rows}; }
  [[nodiscard]] cv::Rect whole() const { return {0, 0, columns, rows}; }

  /// The cells whose square may touch a circle, cut at the borders of the map.
  [[nodiscard]] cv::Rect cells_around(const Eigen::Vector2d& middle, double radius_m) const;

  friend bool operator==(const GridFrame&, const GridFrame&) = default;
};

/// A window that is `cells` larger on all sides, cut to `whole`; empty stays empty.
[[nodiscard]] cv::Rect widened(const cv::Rect& window, int cells, const cv::Rect& whole);

}  // namespace engram::navigation
