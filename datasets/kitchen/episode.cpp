// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/episode.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "datasets/kitchen/entities.h"
#include "datasets/kitchen/stance.h"

namespace engram::datasets::kitchen {

namespace {

constexpr double kTask_s = 17;        ///< Usual duration; no task begins with less time left.
constexpr double kLookAhead_s = 0.5;  ///< How long the neck takes to follow its target.
constexpr double kSpeed_m_s = 0.45;   ///< Mean speed while driving.
constexpr double kTurn_rad_s = 0.55;
constexpr double kBeside_m = 0.19;  ///< From the middle of the robot to what a hand takes.
constexpr double kLift_m = 0.14;
constexpr double kLifted_m = 0.08;  ///< A thing that rose by this much counts as lifted.
constexpr double kShort_m = 0.07;
constexpr double kPlaced_m = 0.04;  ///< A thing this close to its target counts as placed.

constexpr int kStepsPerSample = static_cast<int>(1.0 / (Reporter::kRate_hz * World::kStep_s) + 0.5);

}  // namespace

Episode::Episode(const KitchenOptions& options, World& world, Reporter& reporter,
                 ProgressSink progress)
    : world_(world),
      reporter_(reporter),
      progress_(std::move(progress)),
      script_(world.layout()),
      kinematics_(world),
      trajectory_(RobotVector::Zero()),
      seed_(options.seed),
      samples_(static_cast<uint64_t>(std::llround(options.seconds * Reporter::kRate_hz))) {}

double Episode::now_s() const {
  return static_cast<double>(sample_) / Reporter::kRate_hz;
}

Status Episode::wait(double seconds) {
  // Waits are whole images, so that actions begin and end at the time of an image.
  const auto images = static_cast<uint64_t>(
      std::max(1.0, std::ceil(seconds * Reporter::kRate_hz / Reporter::kImageEvery - 1e-9)));
  for (uint64_t i = 0; i < images * Reporter::kImageEvery && !is_over(); ++i) {
    // Without images the neck moves as if there were some, so that the robot does the same.
    const bool has_image = sample_ % Reporter::kImageEvery == 0;
    if (has_image) follow();
    ENGRAM_RETURN_IF_ERROR(reporter_.record(sample_));
    if (has_image && reporter_.has_images()) ++summary_.images;
    for (int step = 0; step < kStepsPerSample; ++step)
      world_.step(trajectory_.at(now_s() + step * World::kStep_s));
    world_.refresh();
    ++sample_;
    if (progress_ && (has_image || is_over()))
      progress_({.what = fmt::format("simulate kitchen {}", seed_),
                 .done = sample_ / Reporter::kImageEvery,
                 .total = samples_ / Reporter::kImageEvery});
  }
  return {};
}

void Episode::follow() {
  const Eigen::Vector3d at =
      gaze_.thing ? world_.thing_pose(*gaze_.thing).translation() : gaze_.point;
  const auto [yaw, pitch] = kinematics_.look_at(world_.positions(), at);
  trajectory_.move(joint_index("neck_yaw"), yaw, now_s(), kLookAhead_s);
  trajectory_.move(joint_index("neck_pitch"), pitch, now_s(), kLookAhead_s);
}

void Episode::move_joints(const std::vector<int>& joints, const std::vector<double>& to,
                          double seconds) {
  for (size_t i = 0; i < joints.size(); ++i)
    trajectory_.move(joints[i], to.at(i), now_s(), seconds);
}

double Episode::move_hand(Side side, const Pose& pose_world_hand, double seconds) {
  const Kinematics::Answer answer = kinematics_.solve(trajectory_.goal(), side, pose_world_hand);
  std::vector<int> joints = arm_joints(side);
  for (const char* name : {"torso_lift", "torso_pitch", "torso_yaw"})
    joints.push_back(joint_index(name));
  for (const int joint : joints) trajectory_.move(joint, answer.pose[joint], now_s(), seconds);
  return answer.error_m;
}

Status Episode::rest_arm(Side side, double seconds) {
  const RobotVector rest = resting_pose();
  std::vector<int> joints = arm_joints(side);
  for (const int joint : hand_joints(side)) joints.push_back(joint);
  for (const char* name : {"torso_lift", "torso_pitch", "torso_yaw"})
    joints.push_back(joint_index(name));
  for (const int joint : joints) trajectory_.move(joint, rest[joint], now_s(), seconds);
  return wait(0.5 * seconds);
}

Status Episode::run() {
  const SurfacePlace& table = place_of(Surface::kTable);
  RobotVector pose = starting_pose();
  gaze_.point = table.top_m;
  const auto [yaw, pitch] = kinematics_.look_at(pose, gaze_.point);
  pose[joint_index("neck_yaw")] = yaw;
  pose[joint_index("neck_pitch")] = pitch;
  trajectory_ = Trajectory(pose);
  world_.place_robot(pose);
  for (int i = 0; i < kSettlingSteps; ++i) world_.step(trajectory_.at(0));
  world_.refresh();
  reporter_.report_prior(world_.layout());
  ENGRAM_RETURN_IF_ERROR(wait(0.5));

  bool is_first = true;
  while (!is_over()) {
    const double left_s = static_cast<double>(samples_ - sample_) / Reporter::kRate_hz;
    const std::optional<Task> task = is_first || left_s >= kTask_s ? script_.next() : std::nullopt;
    if (!task) break;
    ENGRAM_RETURN_IF_ERROR(perform(*task));
    is_first = false;
  }
  // For the rest of the time the robot looks from surface to surface.
  for (bool at_table = true; !is_over(); at_table = !at_table) {
    gaze_ = {.point = place_of(at_table ? Surface::kTable : Surface::kCounter).top_m};
    ENGRAM_RETURN_IF_ERROR(wait(1.6));
  }
  return {};
}

Status Episode::perform(const Task& task) {
  const ltm::MemoryId command = reporter_.report_speech(sample_, "Ada", task.words);
  plan(task, command);
  ENGRAM_RETURN_IF_ERROR(look(task));
  ENGRAM_RETURN_IF_ERROR(navigate(task, task.from));
  ENGRAM_ASSIGN_OR_RETURN(bool has_it, pick(task, task.fault));
  if (!has_it && !is_over() && is_upright(world_.thing_pose(task.thing))) {
    ENGRAM_RETURN_IF_ERROR(navigate(task, task.from));
    ENGRAM_ASSIGN_OR_RETURN(has_it, pick(task, std::nullopt));
  }
  if (!has_it) {
    if (is_over()) return {};
    script_.lose(task.thing);
    reporter_.report_speech(sample_, "robot", "I could not take it.");
    return rest_arm(task.hand, 1.2);
  }
  ENGRAM_RETURN_IF_ERROR(navigate(task, task.to));
  ENGRAM_ASSIGN_OR_RETURN(const bool stands, place(task));
  if (stands)
    script_.done(task);
  else
    script_.lose(task.thing);
  return {};
}

Status Episode::look(const Task& task) {
  Running running = begin(task, "look", std::nullopt);
  gaze_ = {.thing = task.thing};
  ENGRAM_RETURN_IF_ERROR(wait(0.8));
  const bool is_seen = world_.is_in_sight(task.thing);
  end(running, is_seen ? Outcome::SUCCESS : Outcome::FAILURE,
      is_seen ? "in sight" : "something stands before it");
  return {};
}

Status Episode::navigate(const Task& task, Surface to) {
  Running running = begin(task, "navigate", to);
  const bool carries = world_.held(task.hand).has_value();
  const Eigen::Vector3d point =
      carries ? slot_point(task.to, task.slot) : world_.thing_pose(task.thing).translation();
  Eigen::Vector3d goal = standing_at(point, to, sign_of(task.hand) * kBeside_m);
  const RobotVector now = trajectory_.goal();
  goal[2] = now[2] + std::remainder(goal[2] - now[2], 2 * std::numbers::pi);
  const double way_m = (goal - now.head<3>()).head<2>().norm();
  const double turn_rad = std::abs(goal[2] - now[2]);
  const double seconds = std::max({0.5, way_m / kSpeed_m_s, turn_rad / kTurn_rad_s});
  for (int i = 0; i < kPlatformJoints; ++i) trajectory_.move(i, goal[i], now_s(), seconds);
  gaze_ = carries ? Gaze{.point = point} : Gaze{.thing = task.thing};
  ENGRAM_RETURN_IF_ERROR(wait(seconds + 0.05));
  const double error_m = (world_.positions().head<2>() - goal.head<2>()).norm();
  end(running, error_m < 0.03 ? Outcome::SUCCESS : Outcome::FAILURE,
      fmt::format("{:.3f} m from where it was to be", error_m));
  return {};
}

Result<bool> Episode::pick(const Task& task, std::optional<GraspFault> fault) {
  Running running = begin(task, "pick", task.from);
  gaze_ = {.thing = task.thing};
  const Side side = task.hand;
  const Pose thing = world_.thing_pose(task.thing);
  const ThingClass& type = *world_.layout().things[task.thing].type;
  const Grasp grasp = grasp_of(type, thing, side, place_of(task.from).heading_rad);
  Pose at = thing * grasp.pose_thing_hand;
  if (fault == GraspFault::kShort) at = at * Eigen::Translation3d(-kShort_m, 0, 0);
  move_hand(side, before(at, side), 1.5);
  if (task.is_stopped && fault == task.fault && !has_stopped_) {
    ENGRAM_RETURN_IF_ERROR(stop_reach(running));
    return pick(task, fault);
  }
  ENGRAM_RETURN_IF_ERROR(wait(1.5));
  const double short_m = move_hand(side, at, 0.9);
  ENGRAM_RETURN_IF_ERROR(wait(0.9));
  move_joints(hand_joints(side), hand_around(grasp.width_m), 0.5);
  ENGRAM_RETURN_IF_ERROR(wait(0.55));
  if (is_over()) return false;

  // The hand holds the thing only if it closed at the grasp, so a wrong approach fails by itself.
  const Eigen::Vector3d wanted =
      (world_.thing_pose(task.thing) * grasp.pose_thing_hand).translation();
  const double away_m = (world_.hand_pose(side).translation() - wanted).norm();
  if (away_m < kHoldsWithin_m) world_.hold(side, task.thing);
  Pose up = at;
  up.translation().z() += kLift_m;
  move_hand(side, up, 1.0);
  if (fault == GraspFault::kSlip) {
    ENGRAM_RETURN_IF_ERROR(wait(0.4));
    world_.release(side);
  }
  ENGRAM_RETURN_IF_ERROR(wait(1.0));
  const double lifted_m = world_.thing_pose(task.thing).translation().z() - thing.translation().z();
  const bool has_it = world_.held(side) == task.thing && lifted_m > kLifted_m;
  end(running, has_it ? Outcome::SUCCESS : Outcome::FAILURE,
      away_m < kHoldsWithin_m
          ? fmt::format("lifted {:.3f} m", lifted_m)
          : fmt::format("the hand closed {:.3f} m away from its grasp ({:.3f} m out of reach)",
                        away_m, short_m));
  if (has_it) {
    move_hand(side, carrying_pose(trajectory_.goal(), side, world_.hand_pose(side)), 1.2);
    ENGRAM_RETURN_IF_ERROR(wait(0.6));
    return true;
  }
  ENGRAM_RETURN_IF_ERROR(open_and_draw_back(side));
  return false;
}

Status Episode::stop_reach(Running& running) {
  has_stopped_ = true;
  ENGRAM_RETURN_IF_ERROR(wait(0.9));
  const ltm::MemoryId words = reporter_.report_speech(sample_, "Ada", "Stop!");
  trajectory_.stop(now_s());
  ENGRAM_RETURN_IF_ERROR(wait(0.4));
  end(running, Outcome::STOP, "told to stop", words);
  ENGRAM_RETURN_IF_ERROR(wait(1.0));
  if (!is_over()) reporter_.report_speech(sample_, "Ada", "All right, go on.");
  return wait(0.3);
}

Status Episode::open_and_draw_back(Side side) {
  move_joints(hand_joints(side), open_hand(), 0.5);
  ENGRAM_RETURN_IF_ERROR(wait(0.5));
  move_hand(side, before(world_.hand_pose(side), side), 0.8);
  return wait(0.8);
}

Result<bool> Episode::place(const Task& task) {
  Running running = begin(task, "place", task.to);
  gaze_ = {.thing = task.thing};
  const Side side = task.hand;
  const Pose pose_thing_hand = world_.thing_pose(task.thing).inverse() * world_.hand_pose(side);
  const ThingClass& type = *world_.layout().things[task.thing].type;
  const Pose goal = standing_thing(slot_point(task.to, task.slot), type, pose_thing_hand,
                                   place_of(task.to).heading_rad);
  const Pose at = goal * pose_thing_hand;
  Pose above = at;
  above.translation().z() += kLift_m;
  move_hand(side, above, 1.4);
  ENGRAM_RETURN_IF_ERROR(wait(1.4));
  move_hand(side, at, 0.9);
  ENGRAM_RETURN_IF_ERROR(wait(1.0));
  if (is_over()) return false;
  world_.release(side);
  ENGRAM_RETURN_IF_ERROR(open_and_draw_back(side));
  const Pose now = world_.thing_pose(task.thing);
  const double away_m = (now.translation() - goal.translation()).norm();
  const bool stands = is_upright(now) && away_m < kPlaced_m;
  end(running, stands ? Outcome::SUCCESS : Outcome::FAILURE,
      fmt::format("{} {:.3f} m from its place", is_upright(now) ? "stands" : "lies", away_m));
  ENGRAM_RETURN_IF_ERROR(rest_arm(side, 1.2));
  return stands;
}

}  // namespace engram::datasets::kitchen
