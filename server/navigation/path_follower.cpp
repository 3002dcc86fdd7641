// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/path_follower.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/navigation/free_space.h"

namespace engram::navigation {

namespace {

double approached(double now, double wanted, double max_change) {
  return now + std::clamp(wanted - now, -max_change, max_change);
}

/// Where the robot is after some way on an arc.
PlanarPose on_arc(const PlanarPose& from, double way_m, double curvature_per_m) {
  const double turned = way_m * curvature_per_m;
  if (std::abs(turned) < 1e-6) return from.times({way_m, 0, turned});
  return from.times(
      {std::sin(turned) / curvature_per_m, (1 - std::cos(turned)) / curvature_per_m, turned});
}

/// The obstacle that a robot would not stay clear of if it drove on for the reaction time and then
/// braked.
const Obstacle* first_touched(const PlanarPose& robot, double speed_m_s, double curvature_per_m,
                              const std::vector<Obstacle>& obstacles, const DriveLimits& limits) {
  constexpr double kStepM = 0.02;
  const double braking_m_s2 = limits.acceleration_m_s2;
  const double way_m = speed_m_s * limits.reaction_s + speed_m_s * speed_m_s / (2 * braking_m_s2);
  const double time_s = limits.reaction_s + speed_m_s / braking_m_s2;
  const int steps = 1 + static_cast<int>(way_m / kStepM);
  std::vector<Eigen::Vector2d> points;
  for (int i = 1; i <= steps; ++i)
    points.push_back(on_arc(robot, way_m * i / steps, curvature_per_m).position());
  for (const Obstacle& obstacle : obstacles) {
    const double now_m = obstacle.distance_m(robot.position()) - limits.robot_radius_m;
    const double needed_m = limits.margin_m + obstacle.max_speed_m_s * time_s;
    if (now_m > way_m + needed_m) continue;
    double min_m = now_m;
    for (const Eigen::Vector2d& point : points)
      min_m = std::min(min_m, obstacle.distance_m(point) - limits.robot_radius_m);
    // Driving away from it or along it makes nothing worse, however near it is.
    const bool comes_nearer = min_m < now_m - 1e-6;
    if (comes_nearer && min_m < needed_m) return &obstacle;
  }
  return nullptr;
}

}  // namespace

Status DriveLimits::validate() const {
  for (const double number :
       {max_speed_m_s, max_turn_rad_s, acceleration_m_s2, turn_acceleration_rad_s2, robot_radius_m,
        goal_tolerance_m, goal_tolerance_rad})
    if (!(number > 0 && number < 1000))
      return invalid_argument("drive: found a limit of {}, needs more than 0 and less than 1000",
                              number);
  if (!(reaction_s >= 0 && reaction_s < 10 && margin_m >= 0 && margin_m < 10))
    return invalid_argument("drive: reaction {} s and margin {} m, needs 0 to 10", reaction_s,
                            margin_m);
  return {};
}

SafeSpeed safe_speed(const PlanarPose& robot, double speed_m_s, double curvature_per_m,
                     const std::vector<Obstacle>& obstacles, const DriveLimits& limits) {
  constexpr int kSpeeds = 10;
  SafeSpeed safe;
  for (int i = kSpeeds; i > 0; --i) {
    const double speed = speed_m_s * i / kSpeeds;
    const Obstacle* touched = first_touched(robot, speed, curvature_per_m, obstacles, limits);
    if (touched == nullptr) {
      safe.speed_m_s = speed;
      return safe;
    }
    safe.held_by = *touched;
  }
  return safe;
}

PathFollower::PathFollower(std::vector<PlanarPose> path, const DriveLimits& limits,
                           double last_speed_m_s)
    : path_(std::move(path)), limits_(limits), last_speed_m_s_(last_speed_m_s) {
  ENGRAM_CHECK(path_.size() >= 2, "a way has {} poses", path_.size());
  along_m_.push_back(0);
  for (size_t i = 1; i < path_.size(); ++i)
    along_m_.push_back(along_m_.back() + (path_[i].position() - path_[i - 1].position()).norm());
}

Eigen::Vector2d PathFollower::point_at(double along_m) const {
  const auto next = std::upper_bound(along_m_.begin(), along_m_.end(), along_m);
  if (next == along_m_.end()) return path_.back().position();
  if (next == along_m_.begin()) return path_.front().position();
  const auto i = static_cast<size_t>(next - along_m_.begin());
  const double share = (along_m - along_m_[i - 1]) / (along_m_[i] - along_m_[i - 1]);
  return path_[i - 1].position() + share * (path_[i].position() - path_[i - 1].position());
}

void PathFollower::advance(const Eigen::Vector2d& robot) {
  // Only a little ahead: where a way comes back near to itself the robot must not leave out the
  // part between.
  constexpr double kWindowM = 0.6;
  constexpr double kStepM = 0.02;
  double min_m = (point_at(progress_m_) - robot).norm();
  const double begin = progress_m_;
  for (double along = begin; along <= std::min(begin + kWindowM, along_m_.back() + kStepM);
       along += kStepM) {
    const double distance = (point_at(along) - robot).norm();
    if (distance < min_m) {
      min_m = distance;
      progress_m_ = std::min(along, along_m_.back());
    }
  }
}

PathFollower::Target PathFollower::target(const BaseState& state, const CostMap& map) const {
  // The farthest point to which the robot may go straight: a point farther ahead cuts corners, and
  // those are where furniture is.
  constexpr std::array<double, 6> kAheadM{0.6, 0.45, 0.3, 0.2, 0.12, 0.06};
  for (const double ahead : kAheadM) {
    const Eigen::Vector2d point = point_at(progress_m_ + ahead);
    const bool is_straight = visit_cells(
        map.frame, state.pose_world_robot.position(), point, [&](const cv::Point& cell) {
          return map.frame.has(cell) && map.costs.at<uint8_t>(cell) < kInscribedCost;
        });
    if (is_straight) return {point, ahead};
  }
  return {point_at(progress_m_ + kAheadM.back()), kAheadM.back()};
}

Twist PathFollower::wanted(const BaseState& state, const CostMap& map) {
  const PlanarPose& robot = state.pose_world_robot;
  constexpr double kTurnGain = 3;
  const auto turn_to = [&](double error_rad) {
    // Not faster than it can stop turning at the right heading.
    const double reachable =
        std::sqrt(1.5 * limits_.turn_acceleration_rad_s2 * std::abs(error_rad));
    const double limit = std::min(limits_.max_turn_rad_s, reachable);
    return std::clamp(kTurnGain * error_rad, -limit, limit);
  };
  const double left_m = (path_.back().position() - robot.position()).norm();
  // A robot that turns at its goal may slip by some millimetres without starting over.
  if (left_m <= limits_.goal_tolerance_m) is_at_goal_ = true;
  if (left_m > 2 * limits_.goal_tolerance_m) is_at_goal_ = false;
  if (is_at_goal_) return {0, turn_to(wrapped(path_.back().heading_rad - robot.heading_rad))};

  const Target ahead = target(state, map);
  const Eigen::Vector2d way = robot.inward(ahead.point);
  const double error = std::atan2(way.y(), way.x());
  constexpr double kTurnsInPlaceRad = 0.8;
  if (std::abs(error) > kTurnsInPlaceRad) return {0, turn_to(error)};
  const double braking = std::sqrt(limits_.acceleration_m_s2 * left_m);
  // Near points ahead are followed slowly, or the robot swings around the way.
  const double steady = std::max(0.08, 1.5 * ahead.ahead_m);
  const double speed = std::min({limits_.max_speed_m_s, std::max(0.04, braking), steady}) *
                       std::cos(error) * std::cos(error);
  return {speed, turn_to(error)};
}

PathFollower::Step PathFollower::next(const BaseState& state, const CostMap& map, double period_s) {
  advance(state.pose_world_robot.position());
  Step step;
  const Twist want = wanted(state, map);
  if (is_at_goal_ && std::abs(state.twist.forward_m_s) < 0.01 &&
      std::abs(state.twist.turn_rad_s) < 0.1 &&
      std::abs(wrapped(path_.back().heading_rad - state.pose_world_robot.heading_rad)) <=
          limits_.goal_tolerance_rad) {
    step.has_arrived = true;
    return step;
  }
  step.twist.turn_rad_s = approached(state.twist.turn_rad_s, want.turn_rad_s,
                                     limits_.turn_acceleration_rad_s2 * period_s);
  const double change = limits_.acceleration_m_s2 * period_s;
  // A platform hears late, so it may still be as fast as before the last command. What brakes
  // starts at that command, or it would brake less than each speed before was safe for.
  const double speed = std::min(state.twist.forward_m_s, last_speed_m_s_);
  const double fastest = approached(speed, want.forward_m_s, change);
  if (fastest > 0) {
    const SafeSpeed safe = safe_speed(state.pose_world_robot, fastest,
                                      step.twist.turn_rad_s / fastest, map.obstacles, limits_);
    step.held_by = safe.held_by;
    // It cannot brake harder than it can; the speed before was safe for just that.
    step.twist.forward_m_s = std::max(safe.speed_m_s, std::max(0.0, speed - change));
    // The same arc, slower.
    step.twist.turn_rad_s *= step.twist.forward_m_s > 0 ? step.twist.forward_m_s / fastest : 1;
  }
  last_speed_m_s_ = step.twist.forward_m_s;
  return step;
}

bool PathFollower::is_blocked(const CostMap& map, const PlanarPose& robot) const {
  constexpr double kStepM = 0.02;
  bool is_leaving = !map.is_free(robot.position());
  for (double along = progress_m_; along < along_m_.back() + kStepM; along += kStepM) {
    const uint8_t cost = map.cost_at(point_at(along));
    if (cost < kInscribedCost)
      is_leaving = false;
    else if (!is_leaving || cost >= kLethalCost)
      return true;
  }
  return false;
}

double PathFollower::distance_m(const Eigen::Vector2d& point) const {
  double min_m = (path_.front().position() - point).norm();
  for (size_t i = 1; i < path_.size(); ++i) {
    const Eigen::Vector2d a = path_[i - 1].position();
    const Eigen::Vector2d way = path_[i].position() - a;
    const double length = way.squaredNorm();
    const double share = length == 0 ? 0 : std::clamp((point - a).dot(way) / length, 0.0, 1.0);
    min_m = std::min(min_m, (a + share * way - point).norm());
  }
  return min_m;
}

}  // namespace engram::navigation
