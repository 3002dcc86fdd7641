// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "server/navigation/cost_map.h"

namespace engram::navigation {

/// Keeps the costs of a map up to date while obstacles come, move and go.
///
/// Only the window of a change is made anew: costs differ up to the inflation radius around cells
/// that became blocked or free, and they depend on cells up to that radius around them. The result
/// is, cell by cell, that of a map which is made from nothing (compared in obstacle_map_test).
/// Threading: one thread.
/// Complexity: O(cells of the window) for each change.
class ObstacleMap {
 public:
  /// `base` is a map of walls and rooms that nothing here moves, with the same frame: its lethal
  /// cells are obstacles, its other costs are the least ones, and what it does not know stays
  /// unknown unless the robot would touch something there.
  /// Errors: kInvalidArgument for what does not validate, for a base of another frame, for an
  /// inflation radius of more than 4,000 cells, and for more than GridFrame::kMaxCells cells with a
  /// border as wide as that radius.
  static Result<ObstacleMap> create(const GridFrame& frame, const CostRules& rules,
                                    const std::optional<cv::Mat>& base = {});

  /// Puts or moves an obstacle; `grown_m` is added to its outline on all sides.
  void set(const ltm::MemoryId& entity, const Obstacle& obstacle, double grown_m = 0);

  /// Does nothing where there is no such obstacle.
  void remove(const ltm::MemoryId& entity);

  /// Brings the costs up to date. The Mat is a part of a wider one, which the next call overwrites.
  cv::Mat update();

  [[nodiscard]] const GridFrame& frame() const { return shown_frame_; }
  [[nodiscard]] const CostRules& rules() const { return rules_; }

 private:
  ObstacleMap(const GridFrame& frame, const CostRules& rules);

  /// The cells that an obstacle touches, as runs within rows.
  struct Run {
    int row = 0;
    int first = 0;
    int last = 0;
  };
  [[nodiscard]] std::vector<Run> runs_of(const Obstacle& obstacle) const;
  void count(const std::vector<Run>& runs, int change);
  void note_changed(const cv::Rect& window);
  void write_costs(const cv::Rect& changed);

  GridFrame shown_frame_;
  CostRules rules_;
  int reach_ = 0;  ///< The inflation radius. Unit: cells.
  /// The same with a border as wide as that, since what stands beside the map costs on the map.
  GridFrame frame_;
  cv::Rect shown_;                       ///< The map within that frame.
  std::vector<uint8_t> cost_of_square_;  ///< By the square of a distance in cells.
  std::map<ltm::MemoryId, std::vector<Run>> runs_;
  cv::Mat counts_;    ///< CV_16UC1: how many obstacles touch a cell; those of the base count one.
  cv::Mat passable_;  ///< CV_8UC1: 0 where a cell is blocked, as OpenCV needs it.
  cv::Mat base_;
  cv::Mat costs_;
  std::vector<cv::Rect> changed_;
};

}  // namespace engram::navigation
