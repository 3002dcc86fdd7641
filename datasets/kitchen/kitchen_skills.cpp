// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/kitchen_skills.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "datasets/kitchen/poke.h"
#include "datasets/kitchen/stance.h"

namespace engram::datasets::kitchen {

namespace {

constexpr double kDriveSpeed_m_s = 0.45;
constexpr double kDriveTurn_rad_s = 0.55;
constexpr double kBesideRobot_m = 0.19;  ///< From the middle of the robot to what a hand takes.
constexpr double kAheadOfRobot_m = 0.62;
constexpr double kArrivesWithin_m = 0.03;
constexpr double kRest_s = 0.4;  ///< StopAll takes so long.
constexpr double kMinSkillSpeed = 0.2;
constexpr double kMaxSkillSpeed = 2;

}  // namespace

SkillResult KitchenSkills::ended(bool is_success, std::string reason,
                                 std::map<std::string, double> measured) {
  return {is_success ? SkillEnd::kSuccess : SkillEnd::kFailure, std::move(reason),
          std::move(measured)};
}

Result<SkillResult> KitchenSkills::run(Skill skill, const SkillRequest& request,
                                       const std::stop_token& stop) {
  if (!(request.speed >= kMinSkillSpeed) || request.speed > kMaxSkillSpeed)
    return invalid_argument("skill: speed {}, needs {} to {}", request.speed, kMinSkillSpeed,
                            kMaxSkillSpeed);
  stop_ = stop;
  speed_ = request.speed;
  ENGRAM_RETURN_IF_ERROR(refresh());
  auto result = (this->*skill)(request);
  if (result.ok() || !stop.stop_requested()) return result;
  if (result.status().code() != StatusCode::kCancelled) return result;
  // The stop interrupted a wait. What was commanded before would go on.
  ENGRAM_ASSIGN_OR_RETURN([[maybe_unused]] const double none, tell(StopAll{}));
  stop_ = {};
  speed_ = 1;
  ENGRAM_RETURN_IF_ERROR(wait(kRest_s));
  return SkillResult{SkillEnd::kStop, "told to stop", {{"rest_s", kRest_s}}};
}

Result<SkillResult> KitchenSkills::look(const SkillRequest& request, const std::stop_token& stop) {
  return run(&KitchenSkills::do_look, request, stop);
}
Result<SkillResult> KitchenSkills::navigate(const SkillRequest& request,
                                            const std::stop_token& stop) {
  return run(&KitchenSkills::do_navigate, request, stop);
}
Result<SkillResult> KitchenSkills::pick(const SkillRequest& request, const std::stop_token& stop) {
  return run(&KitchenSkills::do_pick, request, stop);
}
Result<SkillResult> KitchenSkills::place(const SkillRequest& request, const std::stop_token& stop) {
  return run(&KitchenSkills::do_place, request, stop);
}

Status KitchenSkills::refresh() {
  ENGRAM_ASSIGN_OR_RETURN(state_, bus_.now());
  return {};
}

Status KitchenSkills::wait(double seconds) {
  return wait_while(seconds, [] { return true; });
}

Status KitchenSkills::wait_unless_blocked(double seconds) {
  return wait_while(seconds, [this] { return state_.blocked_by.empty(); });
}

Status KitchenSkills::wait_while(double seconds, const std::function<bool()>& goes_on) {
  const auto samples =
      static_cast<uint64_t>(std::max(1.0, std::ceil(seconds / speed_ * RobotBus::kRate_hz - 1e-9)));
  const uint64_t until = state_.sample + samples;
  while (state_.sample < until) {
    // Looked at from sample to sample, and not in between: where time passes in steps, a stop then
    // takes effect at the same sample however quick this is.
    if (stop_.stop_requested()) return cancelled("told to stop");
    ENGRAM_ASSIGN_OR_RETURN(const auto states, bus_.wait(state_.sample + 1, {}));
    if (states.empty()) return unavailable("skill: the body told no state");
    state_ = states.back();
    if (!goes_on()) return {};
  }
  return {};
}

Result<KitchenSkills::Known> KitchenSkills::find(const std::string& name) const {
  std::string there;
  for (const SensedObject& object : state_.objects) {
    const ThingClass* type = class_named(object.name);
    if (type == nullptr) continue;
    if (is_called(*type, name)) return Known{type, object};
    there += (there.empty() ? "" : ", ") + std::string(type->spoken_name);
  }
  return not_found("the kitchen has no '{}'; it has {}", name, there);
}

const SensedObject* KitchenSkills::held(Side side) const {
  const auto found = std::ranges::find(state_.objects, to_string(side), &SensedObject::held_by);
  return found == state_.objects.end() ? nullptr : &*found;
}

Result<Eigen::Vector3d> KitchenSkills::free_point(const SkillRequest& request,
                                                  const std::string& but) const {
  const SurfacePlace& surface = place_of(*request.surface);
  if (request.place)
    return Eigen::Vector3d(request.place->x(), request.place->y(), surface.top_m.z());
  // The nearest to where the hand puts things, so that the place is the same before and after the
  // robot drove to it.
  const Eigen::Rotation2Dd turn(state_.positions[2]);
  const Eigen::Vector2d reach =
      state_.positions.head<2>() +
      turn * Eigen::Vector2d(kAheadOfRobot_m, sign_of(request.hand) * kBesideRobot_m);
  std::optional<Eigen::Vector3d> best;
  for (int slot = 0; slot < kSlots; ++slot) {
    const Eigen::Vector3d point = slot_point(*request.surface, slot);
    const bool is_taken = std::ranges::any_of(state_.objects, [&](const SensedObject& object) {
      return object.name != but &&
             (object.pose.translation() - point).head<2>().norm() < 0.8 * kSlotDistance_m;
    });
    if (is_taken) continue;
    if (!best || (point.head<2>() - reach).norm() < (best->head<2>() - reach).norm()) best = point;
  }
  if (!best) return failed_precondition("all places on {} are taken", surface.spoken_name);
  return *best;
}

Result<double> KitchenSkills::move_hand(Side side, const Pose& to, double seconds) {
  ENGRAM_ASSIGN_OR_RETURN(
      const double short_m,
      tell(MoveHand{.hand = side, .pose_world_hand = to, .seconds = seconds / speed_}));
  ENGRAM_RETURN_IF_ERROR(wait(seconds));
  return short_m;
}

Status KitchenSkills::open_and_draw_back(Side side) {
  ENGRAM_ASSIGN_OR_RETURN(
      [[maybe_unused]] const double opened,
      tell(MoveJoints{.joints = hand_joints(side), .to = open_hand(), .seconds = 0.5 / speed_}));
  ENGRAM_RETURN_IF_ERROR(wait(0.5));
  return move_hand(side, before(hand_pose(side), side), 0.8).status();
}

Status KitchenSkills::rest_arm(Side side) {
  constexpr double kTime_s = 1.2;
  const RobotVector rest = resting_pose();
  MoveJoints move{.joints = arm_joints(side), .to = {}, .seconds = kTime_s / speed_};
  for (const int joint : hand_joints(side)) move.joints.push_back(joint);
  for (const char* name : {"torso_lift", "torso_pitch", "torso_yaw"})
    move.joints.push_back(joint_index(name));
  for (const int joint : move.joints) move.to.push_back(rest[joint]);
  ENGRAM_ASSIGN_OR_RETURN([[maybe_unused]] const double none, tell(move));
  return wait(kTime_s);
}

Result<SkillResult> KitchenSkills::do_look(const SkillRequest& request) {
  LookAt look{.object = {}, .point = {0, 0, 0}};
  if (!request.object.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(const Known object, find(request.object));
    look.object = object.type->name;
  } else if (request.surface) {
    look.point = place_of(*request.surface).top_m;
  } else {
    return invalid_argument("look: needs an object or a surface");
  }
  ENGRAM_ASSIGN_OR_RETURN([[maybe_unused]] const double none, tell(look));
  ENGRAM_RETURN_IF_ERROR(wait(0.8));
  if (look.object.empty()) return ended(true, "looks there", {});
  ENGRAM_ASSIGN_OR_RETURN(const Known object, find(look.object));
  const bool is_seen = object.sensed.is_visible;
  return ended(is_seen, is_seen ? "in sight" : "something stands before it", {});
}

Result<SkillResult> KitchenSkills::do_navigate(const SkillRequest& request) {
  const SensedObject* carried = held(request.hand);
  Eigen::Vector3d goal{0, 0, 0};
  Eigen::Vector3d seen{0, 0, 0};
  const double left_m = sign_of(request.hand) * kBesideRobot_m;
  if (request.surface) {
    seen = place_of(*request.surface).top_m;
    if (carried != nullptr) {
      ENGRAM_ASSIGN_OR_RETURN(seen, free_point(request, carried->name));
    }
    goal = standing_at(seen, *request.surface, carried != nullptr ? left_m : 0);
  } else if (request.place) {
    goal = *request.place;
    seen = goal + Eigen::Vector3d(std::cos(goal.z()), std::sin(goal.z()), 0);
    seen.z() = 0.8;
  } else if (!request.object.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(const Known object, find(request.object));
    seen = object.sensed.pose.translation();
    const auto surface = surface_below(seen);
    if (!surface)
      return ended(false,
                   fmt::format("the {} stands on no surface that the robot drives to",
                               object.type->spoken_name),
                   {});
    goal = standing_at(seen, *surface, left_m);
  } else {
    return invalid_argument("navigate: needs an object, a surface or a place");
  }
  const RobotVector now = state_.positions;
  goal[2] = now[2] + std::remainder(goal[2] - now[2], 2 * std::numbers::pi);
  const double way_m = (goal - now.head<3>()).head<2>().norm();
  const double turn_rad = std::abs(goal[2] - now[2]);
  const double seconds = std::max({0.5, way_m / kDriveSpeed_m_s, turn_rad / kDriveTurn_rad_s});
  ENGRAM_ASSIGN_OR_RETURN([[maybe_unused]] const double looked,
                          tell(LookAt{.object = {}, .point = seen}));
  ENGRAM_ASSIGN_OR_RETURN([[maybe_unused]] const double drives,
                          tell(DriveTo{.pose = goal, .seconds = seconds / speed_}));
  // What blocked it before does not count; the samples after this one know of the drive.
  ENGRAM_RETURN_IF_ERROR(refresh());
  ENGRAM_RETURN_IF_ERROR(wait_unless_blocked(seconds + 0.05));
  const std::string blocked_by = state_.blocked_by;
  if (!blocked_by.empty()) {
    // The drive is over, whatever becomes of the chair.
    ENGRAM_ASSIGN_OR_RETURN([[maybe_unused]] const double stopped, tell(StopAll{}));
    ENGRAM_RETURN_IF_ERROR(wait(kRest_s));
  }
  const double error_m = (state_.positions.head<2>() - goal.head<2>()).norm();
  if (!blocked_by.empty())
    return ended(false,
                 fmt::format("the {} stands in the way, {:.3f} m from where it was to be",
                             blocked_by, error_m),
                 {{"error_m", error_m}, {"way_m", way_m}});
  return ended(error_m < kArrivesWithin_m, fmt::format("{:.3f} m from where it was to be", error_m),
               {{"error_m", error_m}, {"way_m", way_m}});
}

}  // namespace engram::datasets::kitchen
