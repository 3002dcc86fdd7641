// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/drive_run.h"

#include <cmath>

#include "server/navigation/free_space.h"
#include "server/navigation/locations.h"
#include "server/navigation/plan_check.h"

namespace engram::navigation {

namespace {

using ::navigation::EventKind;

/// Planning more often costs time and gains nothing: persons make a step in this time.
constexpr Duration kBetweenPlans = std::chrono::milliseconds(400);
/// A robot that came on by less than this since then is stuck.
constexpr double kCameOnM = 0.05;
/// A provider has this long to make a map of what was moved; it needs a hundredth of it.
constexpr Duration kBetweenChecks = std::chrono::milliseconds(500);
constexpr Duration kStuck = std::chrono::milliseconds(1500);
constexpr double kOffWayM = 0.35;

std::string metres(double length) {
  return fmt::format("{:.2f} m", length);
}

}  // namespace

ChosenPath choose_path(Memory& memory, const PathPlanner& planner, const CostMap& map,
                       const DriveRequest& request, const PlanarPose& robot,
                       const std::optional<PlanarPose>& before) {
  ChosenPath chosen;
  chosen.goal = request.pose;
  if (request.goal.empty()) {
    if (!request.pose.is_finite()) {
      chosen.goal = {};
      chosen.found.reason = "the goal has numbers that are not finite";
      return chosen;
    }
    chosen.found = planner.plan(map, robot, request.pose);
    return chosen;
  }
  const auto named = find_goal(memory, request.goal, map, robot);
  if (!named.ok()) {
    chosen.goal = robot;
    chosen.found.reason = named.status().message();
    return chosen;
  }
  chosen.location = named->location;
  std::vector<PlanarPose> poses = named->poses;
  chosen.goal = poses.front();
  if (before && poses.size() > 1) poses.insert(poses.begin(), *before);
  const FreeSpace space(map);
  const auto out = space.way_out(robot.position(), planner.options().way_out_m);
  const int part = out ? space.part_of(*out) : 0;
  for (const PlanarPose& pose : poses) {
    if (part == 0 || space.part_of(pose.position()) != part) continue;
    chosen.goal = pose;
    chosen.found = planner.plan(map, robot, pose);
    return chosen;
  }
  // None can be reached. That of a free place tells more than that of one that is not free.
  for (const PlanarPose& pose : poses)
    if (space.is_passable(pose.position())) {
      chosen.goal = pose;
      break;
    }
  chosen.found = planner.plan(map, robot, chosen.goal);
  if (poses.size() > 1)
    chosen.found.reason = fmt::format("no free place beside '{}' can be reached: {}", named->name,
                                      chosen.found.reason);
  return chosen;
}

DriveRun::DriveRun(Driver& driver, const DriveRequest& request, DriveBase& base,
                   const std::stop_token& stop, const Driver::Report& report)
    : driver_(driver), request_(request), base_(base), stop_(stop), report_(report) {}

Status DriveRun::look() {
  const Eigen::Vector2d before = state_.pose_world_robot.position();
  const bool is_first = started_ == Time{};
  ENGRAM_ASSIGN_OR_RETURN(state_, base_.state());
  if (!state_.pose_world_robot.is_finite())
    return data_loss("the base says that the robot is at ({}, {}, {})", state_.pose_world_robot.x_m,
                     state_.pose_world_robot.y_m, state_.pose_world_robot.heading_rad);
  if (is_first)
    started_ = state_.time;
  else
    outcome_.travelled_m += (state_.pose_world_robot.position() - before).norm();
  map_ = driver_.maps_->latest();
  return {};
}

Result<DriveOutcome> DriveRun::go() {
  ENGRAM_RETURN_IF_ERROR(look());
  ENGRAM_ASSIGN_OR_RETURN(bool goes_on, plan_first());
  while (goes_on) {
    ENGRAM_ASSIGN_OR_RETURN(goes_on, go_on());
    if (!goes_on) break;
    ENGRAM_RETURN_IF_ERROR(base_.wait(driver_.options_.period));
    ENGRAM_RETURN_IF_ERROR(look());
  }
  outcome_.took = state_.time - started_;
  return outcome_;
}

Result<bool> DriveRun::plan_first() {
  Status current;
  while (true) {
    if (stop_.stop_requested()) return end(EventKind::STOPPED, "stopped before it started");
    if (map_ != nullptr) {
      current = check_map(driver_.memory_, *map_, driver_.options_.rules);
      if (current.ok()) break;
      if (current.code() != StatusCode::kFailedPrecondition) return current;
    }
    if (state_.time - started_ >= driver_.options_.map_patience) break;
    ENGRAM_RETURN_IF_ERROR(base_.wait(driver_.options_.period));
    ENGRAM_RETURN_IF_ERROR(look());
  }
  if (map_ == nullptr)
    return end(EventKind::REFUSED, fmt::format("the memory has no cost map '{}'",
                                               driver_.options_.rules.entity().printable()));
  ChosenPath chosen =
      choose_path(driver_.memory_, driver_.planner_, *map_, request_, state_.pose_world_robot);
  if (!current.ok()) {
    chosen.found = {};
    chosen.found.reason = "the map is stale: " + current.message();
  }
  ENGRAM_RETURN_IF_ERROR(commit_plan(chosen));
  moved_ = state_.time;
  if (chosen.found.is_trapped) {
    // Who stands around it may go on, so it waits as it does on its way.
    blocked_ = state_.time;
    ENGRAM_RETURN_IF_ERROR(
        commit_event(EventKind::BLOCKED, chosen.found.reason, chosen.found.blocked_by));
    return true;
  }
  if (!chosen.found.is_found())
    return end(EventKind::REFUSED, chosen.found.reason, chosen.found.blocked_by);
  goal_ = chosen.goal;
  follower_ = std::make_unique<PathFollower>(chosen.found.path, driver_.options_.limits);
  ENGRAM_RETURN_IF_ERROR(commit_event(
      EventKind::STARTED,
      fmt::format("drives to '{}', {} away", goal_text(request_), metres(chosen.found.length_m))));
  return true;
}

Result<bool> DriveRun::go_on() {
  const Driver::Options& options = driver_.options_;
  if (stop_.stop_requested())
    return end(EventKind::STOPPED, fmt::format("stopped on the way to '{}'", goal_text(request_)));
  if (state_.time - started_ > options.time_limit)
    return end(EventKind::FAILED,
               fmt::format("did not arrive within {}", to_string(options.time_limit)));
  ENGRAM_ASSIGN_OR_RETURN(const bool is_kept, is_map_kept());
  if (!is_kept)
    return end(EventKind::FAILED, fmt::format("nobody keeps the map up to date: {}", stale_));
  const Eigen::Vector2d at = state_.pose_world_robot.position();
  const bool came_on = !here_ || (at - *here_).norm() > kCameOnM;
  if (came_on || std::abs(state_.twist.turn_rad_s) > 0.1) {
    here_ = at;
    moved_ = state_.time;
  }
  if (state_.time - moved_ > options.patience && !blocked_) {
    FoundPath held;
    if (held_by_) held.blocked_by.push_back(*held_by_);
    held.reason = held_by_ ? fmt::format("'{}' stays too near to drive on", held_by_->name)
                           : std::string("the platform does not move");
    const FreeSpace space(*map_);
    held.is_trapped = space.extent_m(space.part_of(at), at) < options.planner.trapped_m;
    return end(held.is_trapped ? EventKind::TRAPPED : EventKind::FAILED, held.reason,
               held.blocked_by);
  }

  const bool is_new = map_->id != looked_at_;
  const bool must_plan = blocked_ ||
                         (is_new && follower_->is_blocked(*map_, state_.pose_world_robot)) ||
                         state_.time - moved_ > kStuck || follower_->distance_m(at) > kOffWayM;
  if (!must_plan) looked_at_ = map_->id;
  if (must_plan && state_.time - planned_ >= kBetweenPlans) {
    // Planning takes some milliseconds, and now and then longer than the reaction that the speed is
    // safe for. So the robot brakes meanwhile, and its next command lets it go on.
    ENGRAM_RETURN_IF_ERROR(base_.stop());
    ENGRAM_ASSIGN_OR_RETURN(const bool goes_on, replan());
    if (!goes_on) return false;
  }
  if (blocked_) {
    ENGRAM_RETURN_IF_ERROR(base_.stop());
    return true;
  }
  const PathFollower::Step step = follower_->next(state_, *map_, to_seconds(options.period));
  held_by_ = step.held_by;
  if (step.has_arrived) {
    const double off_m = (goal_->position() - at).norm();
    return end(EventKind::ARRIVED, fmt::format("stands at '{}', {} from where it should",
                                               goal_text(request_), metres(off_m)));
  }
  ENGRAM_RETURN_IF_ERROR(base_.move(step.twist));
  return true;
}

Result<bool> DriveRun::is_map_kept() {
  if (state_.time - checked_ < kBetweenChecks) return true;
  checked_ = state_.time;
  const Status current = check_map(driver_.memory_, *map_, driver_.options_.rules);
  if (current.ok()) {
    stale_map_ = {};
    return true;
  }
  if (current.code() != StatusCode::kFailedPrecondition) return current;
  // Persons walk, so an object is often newer than a map by some milliseconds. The same map being
  // stale twice is something else: whoever makes maps died, and the robot would drive blindly.
  const bool is_again = stale_map_ == map_->id;
  stale_map_ = map_->id;
  stale_ = current.message();
  return !is_again;
}

Result<bool> DriveRun::replan() {
  planned_ = state_.time;
  looked_at_ = map_->id;
  const ChosenPath chosen = choose_path(driver_.memory_, driver_.planner_, *map_, request_,
                                        state_.pose_world_robot, goal_);
  if (!chosen.found.is_found()) {
    if (!blocked_) {
      blocked_ = state_.time;
      ENGRAM_RETURN_IF_ERROR(base_.stop());
      ENGRAM_RETURN_IF_ERROR(commit_plan(chosen));
      ENGRAM_RETURN_IF_ERROR(
          commit_event(EventKind::BLOCKED, chosen.found.reason, chosen.found.blocked_by));
    }
    return wait_or_give_up(chosen.found);
  }
  blocked_.reset();
  goal_ = chosen.goal;
  ENGRAM_RETURN_IF_ERROR(commit_plan(chosen));
  follower_ = std::make_unique<PathFollower>(chosen.found.path, driver_.options_.limits);
  ++outcome_.replans;
  ENGRAM_RETURN_IF_ERROR(commit_event(
      EventKind::REPLANNED, fmt::format("takes another way to '{}', {} long", goal_text(request_),
                                        metres(chosen.found.length_m))));
  return true;
}

Result<bool> DriveRun::wait_or_give_up(const FoundPath& blocked) {
  const Duration waited = state_.time - *blocked_;
  if (waited < driver_.options_.patience) return true;
  return end(blocked.is_trapped ? EventKind::TRAPPED : EventKind::FAILED,
             fmt::format("waited {}, and {}", to_string(driver_.options_.patience), blocked.reason),
             blocked.blocked_by);
}

Status DriveRun::commit_plan(const ChosenPath& chosen) {
  const PathPlanner::Options& planner = driver_.planner_.options();
  planned_ = state_.time;
  ENGRAM_ASSIGN_OR_RETURN(outcome_.plan,
                          driver_.log_.commit_plan(request_, chosen.found,
                                                   {*map_, state_.pose_world_robot, chosen.goal,
                                                    chosen.location, planner.seed},
                                                   state_.time));
  return {};
}

Status DriveRun::commit_event(EventKind kind, const std::string& reason,
                              const std::vector<Obstacle>& blocked_by) {
  ENGRAM_ASSIGN_OR_RETURN(outcome_.event,
                          driver_.log_.commit_event(request_,
                                                    {kind, reason, outcome_.plan,
                                                     map_ == nullptr ? ltm::MemoryId() : map_->id,
                                                     blocked_by, state_.pose_world_robot},
                                                    state_.time));
  if (report_) report_(kind, reason);
  return {};
}

Result<bool> DriveRun::end(EventKind kind, const std::string& reason,
                           const std::vector<Obstacle>& blocked_by) {
  ENGRAM_RETURN_IF_ERROR(base_.stop());
  constexpr Duration kLongestStop = std::chrono::seconds(3);
  const Time stopping = state_.time;
  while (std::abs(state_.twist.forward_m_s) > 0.005 && state_.time - stopping < kLongestStop) {
    ENGRAM_RETURN_IF_ERROR(base_.wait(driver_.options_.period));
    ENGRAM_RETURN_IF_ERROR(look());
  }
  outcome_.kind = kind;
  outcome_.reason = reason;
  ENGRAM_RETURN_IF_ERROR(commit_event(kind, reason, blocked_by));
  return false;
}

}  // namespace engram::navigation
