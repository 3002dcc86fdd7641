// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/free_space.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace engram::navigation {

namespace {

void sort_by_distance(std::vector<Obstacle>& obstacles, const Eigen::Vector2d& from) {
  std::stable_sort(obstacles.begin(), obstacles.end(), [&](const Obstacle& a, const Obstacle& b) {
    return a.distance_m(from) < b.distance_m(from);
  });
}

}  // namespace

FreeSpace::FreeSpace(const CostMap& map, uint8_t blocked_from,
                     const std::vector<Eigen::Vector2d>& near, double near_m)
    : map_(map) {
  cv::Mat passable = map.costs < blocked_from;
  for (const Eigen::Vector2d& point : near) {
    const cv::Rect window = map.frame.cells_around(point, near_m);
    for (int row = window.y; row < window.br().y; ++row)
      for (int column = window.x; column < window.br().x; ++column)
        if (map.costs.at<uint8_t>(row, column) < kInscribedCost &&
            (map.frame.middle_of({column, row}) - point).norm() <= near_m)
          passable.at<uint8_t>(row, column) = 255;
  }
  constexpr int kBySides = 4;
  cv::connectedComponents(passable, parts_, kBySides, CV_32S);
}

bool FreeSpace::is_passable(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const {
  return visit_cells(map_.frame, from, to, [&](const cv::Point& cell) {
    return map_.frame.has(cell) && parts_.at<int>(cell) > 0;
  });
}

int FreeSpace::part_of(const Eigen::Vector2d& point) const {
  const cv::Point cell = map_.frame.cell_of(point);
  return map_.frame.has(cell) ? parts_.at<int>(cell) : 0;
}

std::optional<Eigen::Vector2d> FreeSpace::way_out(const Eigen::Vector2d& point,
                                                  double max_m) const {
  if (is_passable(point)) return point;
  const auto is_over_no_obstacle = [&](const cv::Point& cell) {
    return map_.frame.has(cell) && map_.costs.at<uint8_t>(cell) < kLethalCost;
  };
  std::optional<Eigen::Vector2d> next;
  double min_m = max_m;
  const cv::Rect window = map_.frame.cells_around(point, max_m);
  for (int row = window.y; row < window.br().y; ++row)
    for (int column = window.x; column < window.br().x; ++column) {
      if (parts_.at<int>(row, column) == 0) continue;
      const Eigen::Vector2d middle = map_.frame.middle_of({column, row});
      const double distance = (middle - point).norm();
      if (distance >= min_m || !visit_cells(map_.frame, point, middle, is_over_no_obstacle))
        continue;
      min_m = distance;
      next = middle;
    }
  return next;
}

double FreeSpace::extent_m(int part, const Eigen::Vector2d& from) const {
  double farthest = 0;
  for (int row = 0; row < parts_.rows; ++row)
    for (int column = 0; column < parts_.cols; ++column)
      if (parts_.at<int>(row, column) == part)
        farthest = std::max(farthest, (map_.frame.middle_of({column, row}) - from).norm());
  return farthest;
}

double FreeSpace::blocked_m(const Obstacle& obstacle) const {
  // Beyond what makes a cell blocked: one cell to the border and one for where its middle is. What
  // moves is kept away from by what it may go in the time of a reaction, at most a quarter second.
  constexpr double kLongReactionS = 0.25;
  return map_.inscribed_m + obstacle.max_speed_m_s * kLongReactionS + 2.5 * map_.frame.resolution_m;
}

std::vector<Obstacle> FreeSpace::around(int part, const Eigen::Vector2d& from) const {
  std::vector<Obstacle> around;
  for (const Obstacle& obstacle : map_.obstacles) {
    const double near_m = blocked_m(obstacle);
    const cv::Rect window = map_.frame.cells_around(obstacle.pose_world_obstacle.position(),
                                                    obstacle.outer_radius_m() + near_m);
    bool is_near = false;
    for (int row = window.y; row < window.br().y && !is_near; ++row)
      for (int column = window.x; column < window.br().x && !is_near; ++column)
        is_near = parts_.at<int>(row, column) == part &&
                  obstacle.distance_m(map_.frame.middle_of({column, row})) <= near_m;
    if (is_near) around.push_back(obstacle);
  }
  sort_by_distance(around, from);
  return around;
}

std::vector<Obstacle> FreeSpace::touched_at(const Eigen::Vector2d& point) const {
  std::vector<Obstacle> touched;
  for (const Obstacle& obstacle : map_.obstacles)
    if (obstacle.distance_m(point) <= blocked_m(obstacle)) touched.push_back(obstacle);
  sort_by_distance(touched, point);
  return touched;
}

}  // namespace engram::navigation
