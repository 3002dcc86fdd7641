// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/drive_run.h"

#include <cmath>
#include <limits>

#include "server/navigation/free_space.h"
#include "server/navigation/plan_check.h"

namespace engram::navigation {

namespace {

using ::navigation::EventKind;

/// Planning more often costs time and gains nothing: persons make a step in this time.
constexpr Duration kBetweenPlans = std::chrono::milliseconds(400);
/// A robot that came on and turned by less than this since then is stuck.
constexpr double kCameOnM = 0.05;
constexpr double kCameOnRad = 0.1;
/// A provider has this long to make a map of what was moved; it needs a hundredth of it.
constexpr Duration kBetweenChecks = std::chrono::milliseconds(500);
/// A robot that does not come on by its plan for this long makes another one.
constexpr Duration kStuck = std::chrono::milliseconds(1500);
constexpr double kOffWayM = 0.35;
/// What is slower than this rests.
constexpr double kRestsMS = 0.005;
constexpr double kRestsRadS = 0.02;

std::string metres(double length) {
  return fmt::format("{:.2f} m", length);
}

}  // namespace

DriveRun::DriveRun(Driver& driver, const DriveRequest& request, DriveBase& base,
                   const std::stop_token& stop, const Driver::Report& report)
    : driver_(driver), request_(request), base_(base), stop_(stop), report_(report) {}

Status DriveRun::look() {
  // The map first: the robot may move on while it comes.
  using Newest = Result<std::shared_ptr<const CostMap>>;
  ENGRAM_ASSIGN_OR_RETURN(map_, asked([this]() -> Newest { return driver_.maps_->latest(); }));
  was_late_ = false;
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
  return {};
}

PathInputs DriveRun::path_inputs() const {
  return {driver_.memory_, driver_.options_.rules, *map_, state_.pose_world_robot};
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
  ENGRAM_ASSIGN_OR_RETURN(ChosenPath chosen,
                          choose_path(path_inputs(), driver_.planner_, request_));
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
  keep_goal(chosen);
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
  note_motion();
  if (state_.time - moved_ > options.patience && !blocked_) {
    FoundPath held;
    if (held_by_) held.blocked_by.push_back(*held_by_);
    held.reason = held_by_ ? fmt::format("'{}' stays too near to drive on", held_by_->name)
                           : std::string("the platform does not move");
    const FreeSpace space(*map_);
    const Eigen::Vector2d at = state_.pose_world_robot.position();
    held.is_trapped = space.extent_m(space.part_of(at), at) < options.planner.trapped_m;
    return end(held.is_trapped ? EventKind::TRAPPED : EventKind::FAILED, held.reason,
               held.blocked_by);
  }

  bool is_there = true;
  if (!blocked_) {
    ENGRAM_ASSIGN_OR_RETURN(is_there, is_goal_there(false));
  }
  const bool is_new = map_->id != looked_at_;
  const bool must_plan = blocked_ || !is_there ||
                         (is_new && follower_->is_blocked(*map_, state_.pose_world_robot)) ||
                         state_.time - std::max(moved_, planned_) > kStuck ||
                         follower_->distance_m(state_.pose_world_robot.position()) > kOffWayM;
  if (!must_plan) looked_at_ = map_->id;
  if (must_plan && state_.time - planned_ >= kBetweenPlans) {
    ENGRAM_ASSIGN_OR_RETURN(const bool goes_on, replan());
    if (!goes_on) return false;
  }
  if (blocked_) {
    ENGRAM_RETURN_IF_ERROR(base_.stop());
    return true;
  }
  if (was_late_) {
    ENGRAM_RETURN_IF_ERROR(look());
  }
  const PathFollower::Step step = follower_->next(state_, *map_, to_seconds(options.period));
  held_by_ = step.held_by;
  if (step.has_arrived) {
    // The thing may have been moved since it was last looked for.
    ENGRAM_ASSIGN_OR_RETURN(is_there, is_goal_there(true));
    if (!is_there) return replan();
    const double off_m = (goal_->pose.position() - state_.pose_world_robot.position()).norm();
    return end(EventKind::ARRIVED, fmt::format("stands at '{}', {} from where it should",
                                               goal_text(request_), metres(off_m)));
  }
  ENGRAM_RETURN_IF_ERROR(base_.move(step.twist));
  return true;
}

void DriveRun::note_motion() {
  const PlanarPose& robot = state_.pose_world_robot;
  // A robot that turns where it stands does what its plan says.
  if (here_ && (robot.position() - here_->position()).norm() <= kCameOnM &&
      std::abs(wrapped(robot.heading_rad - here_->heading_rad)) <= kCameOnRad)
    return;
  here_ = robot;
  moved_ = state_.time;
}

Result<bool> DriveRun::is_map_kept() {
  if (state_.time - checked_ < kBetweenChecks) return true;
  checked_ = state_.time;
  const Status current =
      asked([&] { return check_map(driver_.memory_, *map_, driver_.options_.rules); });
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

Result<bool> DriveRun::is_goal_there(bool is_urgent) {
  if (!goal_ || goal_->name.empty()) return true;
  if (!is_urgent && state_.time - goal_checked_ < kBetweenChecks) return true;
  ENGRAM_ASSIGN_OR_RETURN(const bool is_there,
                          asked([&] { return is_goal_near(path_inputs(), *goal_); }));
  // Where it is not there, it is asked again until the robot plans.
  if (is_there) goal_checked_ = state_.time;
  return is_there;
}

void DriveRun::keep_goal(const ChosenPath& chosen) {
  goal_ = KeptGoal{chosen.goal, chosen.name};
  goal_checked_ = state_.time;
}

Result<bool> DriveRun::replan() {
  // Planning takes some milliseconds, and now and then longer than the reaction that the speed is
  // safe for; memories may take any time. So the robot brakes meanwhile, and its next command, for
  // which it looks anew, lets it go on.
  ENGRAM_RETURN_IF_ERROR(base_.stop());
  was_late_ = true;
  planned_ = state_.time;
  looked_at_ = map_->id;
  ENGRAM_ASSIGN_OR_RETURN(const ChosenPath chosen,
                          choose_path(path_inputs(), driver_.planner_, request_, goal_));
  if (!chosen.found.is_found()) {
    if (!blocked_) {
      blocked_ = state_.time;
      ENGRAM_RETURN_IF_ERROR(commit_plan(chosen));
      ENGRAM_RETURN_IF_ERROR(
          commit_event(EventKind::BLOCKED, chosen.found.reason, chosen.found.blocked_by));
    }
    return wait_or_give_up(chosen.found);
  }
  // While no way led on it was not the platform that did not move. Another way while there was one
  // does not renew its patience: the robot stands as long as something is too near.
  if (blocked_) {
    blocked_.reset();
    moved_ = state_.time;
    here_ = state_.pose_world_robot;
  }
  keep_goal(chosen);
  ENGRAM_RETURN_IF_ERROR(commit_plan(chosen));
  // Where nothing was commanded yet, what the base measures is all there is.
  const double speed_m_s =
      follower_ ? follower_->last_speed_m_s() : std::numeric_limits<double>::infinity();
  follower_ = std::make_unique<PathFollower>(chosen.found.path, driver_.options_.limits, speed_m_s);
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
  // The last command before the stop may not have reached the platform yet.
  const Duration heard =
      follower_ ? duration_from_seconds(driver_.options_.limits.reaction_s).value() : Duration();
  const auto rests = [&] {
    return state_.time - stopping >= heard && std::abs(state_.twist.forward_m_s) <= kRestsMS &&
           std::abs(state_.twist.turn_rad_s) <= kRestsRadS;
  };
  while (!rests() && state_.time - stopping < kLongestStop) {
    ENGRAM_RETURN_IF_ERROR(base_.wait(driver_.options_.period));
    ENGRAM_RETURN_IF_ERROR(look());
  }
  outcome_.kind = kind;
  outcome_.reason = reason;
  ENGRAM_RETURN_IF_ERROR(commit_event(kind, reason, blocked_by));
  return false;
}

}  // namespace engram::navigation
