// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "server/navigation/cost_map.h"
#include "server/navigation/drive_base.h"

namespace engram::navigation {

/// How a robot may drive.
struct DriveLimits {
  double max_speed_m_s = 0.6;
  double max_turn_rad_s = 1.5;
  /// For speeding up and for braking; what the platform keeps also with its load. Unit: m/s^2.
  double acceleration_m_s2 = 1.0;
  double turn_acceleration_rad_s2 = 4;
  /// From when an obstacle is somewhere until the robot brakes for it: the age of the map, the
  /// period of control, the delay of the platform. Unit: s.
  double reaction_s = 0.24;
  double robot_radius_m = 0.3;
  double margin_m = 0.02;  ///< What it keeps from obstacles at least.
  double goal_tolerance_m = 0.03;
  double goal_tolerance_rad = 0.05;

  [[nodiscard]] Status validate() const;
};

/// Drives along a way by pure pursuit: towards a point of the way that lies a little ahead, as far
/// as the map lets it go there straight.
///
/// It never drives faster than it can stop: if it braked from its next speed after the reaction
/// time, the robot would rest before it touches where any obstacle is, or, for one that moves,
/// where that may be by then. Something that comes from behind does not hold it up. Threading: one
/// thread. Source: Coulter, "Implementation of the Pure Pursuit Path Tracking Algorithm", 1992; for
/// the speed ISO 13855, speed and separation monitoring.
class PathFollower {
 public:
  /// The way has at least its start and its goal. `last_speed_m_s`: that of the last command
  /// before, for a robot that drives already; what it measures may be older.
  PathFollower(std::vector<PlanarPose> path, const DriveLimits& limits,
               double last_speed_m_s = std::numeric_limits<double>::infinity());

  struct Step {
    Twist twist;
    std::optional<Obstacle> held_by;  ///< What makes the robot slower than it would be.
    bool has_arrived = false;
  };

  /// What to do for the next `period_s`. `state` is not older than the reaction time.
  Step next(const BaseState& state, const CostMap& map, double period_s);

  /// The first obstacles on the rest of the way, by the map; empty where it is free. A robot that
  /// starts too near to something may leave it.
  [[nodiscard]] bool is_blocked(const CostMap& map, const PlanarPose& robot) const;

  /// How far the robot is beside the way. Unit: m.
  [[nodiscard]] double distance_m(const Eigen::Vector2d& point) const;

  [[nodiscard]] const std::vector<PlanarPose>& path() const { return path_; }
  [[nodiscard]] double last_speed_m_s() const { return last_speed_m_s_; }

 private:
  struct Target {
    Eigen::Vector2d point = Eigen::Vector2d::Zero();
    double ahead_m = 0;
  };

  [[nodiscard]] Eigen::Vector2d point_at(double along_m) const;
  void advance(const Eigen::Vector2d& robot);
  [[nodiscard]] Target target(const BaseState& state, const CostMap& map) const;
  [[nodiscard]] Twist wanted(const BaseState& state, const CostMap& map);

  std::vector<PlanarPose> path_;
  std::vector<double> along_m_;  ///< Of each corner.
  const DriveLimits limits_;
  double progress_m_ = 0;
  double last_speed_m_s_;    ///< Of the last command.
  bool is_at_goal_ = false;  ///< It only turns any more.
};

/// The fastest speed on an arc, at most `speed_m_s`, from which the robot could stop in time, and
/// what limits it.
struct SafeSpeed {
  double speed_m_s = 0;
  std::optional<Obstacle> held_by;
};
[[nodiscard]] SafeSpeed safe_speed(const PlanarPose& robot, double speed_m_s,
                                   double curvature_per_m, const std::vector<Obstacle>& obstacles,
                                   const DriveLimits& limits);

}  // namespace engram::navigation
