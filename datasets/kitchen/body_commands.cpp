// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "datasets/kitchen/body.h"
#include "datasets/kitchen/movable_places.h"
#include "datasets/kitchen/poke.h"
#include "datasets/kitchen/stance.h"

namespace engram::datasets::kitchen {

namespace {

constexpr double kMinTime_s = 0.1;
constexpr double kMaxTime_s = 600;
constexpr double kFarthest_m = 100;  ///< Nothing that the robot is told is farther away.

Status check_time(double seconds) {
  if (seconds >= kMinTime_s && seconds <= kMaxTime_s) return {};
  return invalid_argument("found a movement of {} s, needs {} to {}", seconds, kMinTime_s,
                          kMaxTime_s);
}

Status check_vector(const Eigen::Vector3d& vector) {
  if (vector.allFinite() && vector.norm() < kFarthest_m) return {};
  return invalid_argument("found ({}, {}, {}), needs finite numbers below {}", vector.x(),
                          vector.y(), vector.z(), kFarthest_m);
}

}  // namespace

Result<double> Body::command(const BodyCommand& command) {
  return std::visit([this](const auto& one) { return carry_out(one); }, command);
}

Result<double> Body::carry_out(const MoveJoints& command) {
  ENGRAM_RETURN_IF_ERROR(check_time(command.seconds));
  if (command.joints.size() != command.to.size())
    return invalid_argument("found {} joints and {} targets, needs as many", command.joints.size(),
                            command.to.size());
  for (size_t i = 0; i < command.joints.size(); ++i) {
    if (command.joints[i] < kPlatformJoints || command.joints[i] >= kRobotJoints)
      return invalid_argument("found joint {}, needs {} to {}", command.joints[i], kPlatformJoints,
                              kRobotJoints - 1);
    if (!std::isfinite(command.to[i]))
      return invalid_argument("found the target {} of a joint, needs a number", command.to[i]);
  }
  for (size_t i = 0; i < command.joints.size(); ++i) {
    const auto [low, high] = world_->range(command.joints[i]);
    trajectory_.move(command.joints[i], std::clamp(command.to[i], low, high), now_s(),
                     command.seconds);
  }
  return 0.0;
}

Result<double> Body::carry_out(const MoveHand& command) {
  ENGRAM_RETURN_IF_ERROR(check_time(command.seconds));
  ENGRAM_RETURN_IF_ERROR(check_vector(command.pose_world_hand.translation()));
  if (!command.pose_world_hand.linear().allFinite() ||
      !command.pose_world_hand.linear().isUnitary(1e-3))
    return invalid_argument("found a pose of a hand that is no rotation");
  const Kinematics::Answer answer =
      kinematics_.solve(trajectory_.goal(), command.hand, command.pose_world_hand);
  std::vector<int> joints = arm_joints(command.hand);
  for (const char* name : {"torso_lift", "torso_pitch", "torso_yaw"})
    joints.push_back(joint_index(name));
  for (const int joint : joints)
    trajectory_.move(joint, answer.pose[joint], now_s(), command.seconds);
  return answer.error_m;
}

Result<double> Body::carry_out(const LookAt& command) {
  if (command.object.empty()) {
    ENGRAM_RETURN_IF_ERROR(check_vector(command.point));
    gaze_ = {.point = command.point};
    return 0.0;
  }
  ENGRAM_ASSIGN_OR_RETURN(const size_t object, object_named(command.object));
  const size_t things = world_->layout().things.size();
  if (object < things)
    gaze_ = {.thing = object};
  else
    gaze_ = {.movable = object - things};
  return 0.0;
}

Result<double> Body::carry_out(const DriveTo& command) {
  ENGRAM_RETURN_IF_ERROR(check_time(command.seconds));
  ENGRAM_RETURN_IF_ERROR(check_vector(command.pose));
  drive_.end();
  blocked_by_.clear();
  for (int i = 0; i < kPlatformJoints; ++i)
    trajectory_.move(i, command.pose[i], now_s(), command.seconds);
  return 0.0;
}

Result<double> Body::carry_out(const Drive& command) {
  // A platform that is blocked brakes already; braking anew would take longer.
  const bool was_blocked = !blocked_by_.empty();
  if (Status wrong = check_vector(command.velocity); !wrong.ok()) {
    // Whoever drives wants something else than before, so the velocity of before must not go on.
    if (!was_blocked) brake();
    return wrong;
  }
  // Else it would creep towards what is in its way, a bit with each command.
  const Eigen::Rotation2Dd turn(world_->positions()[2]);
  blocked_by_ = in_the_way(turn * command.velocity.head<2>());
  if (blocked_by_.empty())
    drive_.want(command.velocity, now_s());
  else if (!was_blocked)
    brake();
  return 0.0;
}

Result<double> Body::carry_out(const Hold& command) {
  ENGRAM_ASSIGN_OR_RETURN(const size_t thing, thing_named(command.object));
  ENGRAM_RETURN_IF_ERROR(check_vector(command.grasp_object));
  for (const Side side : {Side::kLeft, Side::kRight})
    if (world_->held(side) == thing || (side == command.hand && world_->held(side)))
      return failed_precondition("the {} hand already holds the {}", to_string(side),
                                 type_of(*world_->held(side)).name);
  const Eigen::Vector3d wanted = world_->thing_pose(thing) * command.grasp_object;
  const double away_m = (world_->hand_pose(command.hand).translation() - wanted).norm();
  // A hand that closed beside the thing holds nothing.
  if (away_m < kHoldsWithin_m) world_->hold(command.hand, thing);
  return away_m;
}

Result<double> Body::carry_out(const Release& command) {
  world_->release(command.hand);
  return 0.0;
}

Result<double> Body::carry_out(const StopAll& /*command*/) {
  drive_.end();
  trajectory_.stop(now_s());
  return 0.0;
}

Result<std::string> Body::poke(const std::string& what) {
  ENGRAM_ASSIGN_OR_RETURN(const Poke poke, parse_poke(what));
  ENGRAM_ASSIGN_OR_RETURN(const size_t object, object_named(poke.name));
  const size_t things = world_->layout().things.size();
  if (object < things) {
    if (poke.surface) return put_thing(object, *poke.surface);
    return invalid_argument("poke '{}': found a thing, needs it to go to the counter or the table",
                            what);
  }
  const size_t movable = object - things;
  if (poke.is_away) return put_movable(movable, place_away(movable));
  if (poke.surface)
    return invalid_argument("poke '{}': found the {}, needs a place on the floor as X,Y", what,
                            type_of(object).name);
  const Pose at = standing_movable(type_of(object), poke.at.x(), poke.at.y(), poke.at.z());
  ENGRAM_RETURN_IF_ERROR(check_room_for(type_of(object), at));
  return put_movable(movable, at);
}

Result<std::string> Body::put_movable(size_t movable, const Pose& at) {
  const ThingClass& type = movable_classes()[movable];
  const Eigen::Vector2d robot = world_->positions().head<2>();
  const Eigen::Vector3d to = at.translation();
  if (distance_m(type, at, robot) < kPlatformRadius_m)
    return failed_precondition("the {} has no place at {:g},{:g}: the robot is there", type.name,
                               to.x(), to.y());
  for (size_t i = 0; i < movable_classes().size(); ++i) {
    const Eigen::Vector3d other = world_->movable_pose(i).translation();
    const double needed = 0.5 * (type.size_m.x() + movable_classes()[i].size_m.x());
    if (i != movable && (other - to).head<2>().norm() < needed)
      return failed_precondition("the {} has no place at {:g},{:g}: the {} is there", type.name,
                                 to.x(), to.y(), movable_classes()[i].name);
  }
  world_->place_movable(movable, at);
  world_->refresh();
  has_news_ = true;
  // What was in the way may be gone.
  if (blocked_by_ == type.name) blocked_by_.clear();
  if (is_away(at)) return fmt::format("the {} left the kitchen", type.name);
  return fmt::format("the {} is at {:g},{:g}", type.name, to.x(), to.y());
}

Result<std::string> Body::put_thing(size_t thing, Surface surface) {
  const ThingClass& type = type_of(thing);
  for (const Side side : {Side::kLeft, Side::kRight})
    if (world_->held(side) == thing)
      return failed_precondition("the {} is in the robot's {} hand", type.spoken_name,
                                 to_string(side));
  // The first slot that nothing stands in or leans into.
  for (int slot = 0; slot < kSlots; ++slot) {
    const Eigen::Vector3d foot = slot_point(surface, slot);
    bool is_free = true;
    for (size_t i = 0; i < world_->layout().things.size(); ++i)
      is_free = is_free && (i == thing ||
                            (world_->thing_pose(i).translation() - foot).norm() > kSlotDistance_m);
    if (!is_free) continue;
    world_->place_thing(
        thing, standing_thing(foot, type, Pose::Identity(), place_of(surface).heading_rad));
    world_->refresh();
    has_news_ = true;
    return fmt::format("the {} is on {}", type.spoken_name, place_of(surface).spoken_name);
  }
  return failed_precondition("the {} has no place on {}: its {} places are taken", type.spoken_name,
                             place_of(surface).spoken_name, kSlots);
}

}  // namespace engram::datasets::kitchen
