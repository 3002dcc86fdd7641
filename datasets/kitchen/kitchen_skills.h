// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <stop_token>
#include <string>

#include "datasets/kitchen/robot_bus.h"
#include "datasets/kitchen/things.h"

namespace engram::datasets::kitchen {

/// What a skill is to do.
struct SkillRequest {
  std::string object;              ///< By any of its names: salt_box, salt, salt_box_1.
  std::optional<Surface> surface;  ///< Where an object is to stand, or what to look at or drive to.
  /// x, y, heading of the platform, or where on a surface an object is to stand (x, y).
  std::optional<Eigen::Vector3d> place;
  Side hand = Side::kRight;
  double speed = 1;  ///< 0.2 to 2: how much quicker than usual.
};

enum class SkillEnd { kSuccess, kFailure, kStop };

/// How a skill ended.
struct SkillResult {
  SkillEnd end = SkillEnd::kFailure;
  std::string reason;                      ///< What was measured, in words.
  std::map<std::string, double> measured;  ///< Names end in their unit.
};

/// What the robot of the kitchen can do, over its bus. Outcomes are measured, as in recordings.
///
/// When a stop is requested, arms and platform come to rest within 0.4 s, and the skill ends with
/// kStop; what a hand holds stays in it.
/// Errors of all skills: kNotFound if there is no such object; kInvalidArgument for a request that
/// lacks something; those of the bus.
/// Threading: one thread. The bus must outlive it.
/// Source: docs/kitchen.md, section "Live".
class KitchenSkills {
 public:
  explicit KitchenSkills(RobotBus& bus) : bus_(bus) {}

  /// Turns the head to an object or a surface. Succeeds if the object is in sight.
  Result<SkillResult> look(const SkillRequest& request, const std::stop_token& stop);

  /// Drives straight to where a hand reaches the object, the surface, or to `place`. It carries
  /// what it holds. Succeeds within 3 cm; fails before a chair or a person that stands in the way.
  Result<SkillResult> navigate(const SkillRequest& request, const std::stop_token& stop);

  /// Grasps the object with the hand and lifts it. Succeeds if it is held and 8 cm higher.
  Result<SkillResult> pick(const SkillRequest& request, const std::stop_token& stop);

  /// Puts what the hand holds on the surface: on `place`, else in a free place. Succeeds if it
  /// stands upright within 4 cm of it.
  Result<SkillResult> place(const SkillRequest& request, const std::stop_token& stop);

 private:
  /// An object that a request is about.
  struct Known {
    const ThingClass* type = nullptr;
    SensedObject sensed;
  };

  using Skill = Result<SkillResult> (KitchenSkills::*)(const SkillRequest&);

  static SkillResult ended(bool is_success, std::string reason,
                           std::map<std::string, double> measured);
  /// Runs a skill; a stop becomes its result.
  Result<SkillResult> run(Skill skill, const SkillRequest& request, const std::stop_token& stop);
  Result<SkillResult> do_look(const SkillRequest& request);
  Result<SkillResult> do_navigate(const SkillRequest& request);
  Result<SkillResult> do_pick(const SkillRequest& request);
  Result<SkillResult> do_place(const SkillRequest& request);

  /// Lets time pass. Errors: kCancelled if a stop is requested.
  Status wait(double seconds);
  /// The same until the platform stopped before something.
  Status wait_unless_blocked(double seconds);
  Status wait_while(double seconds, const std::function<bool()>& goes_on);
  Result<double> tell(const BodyCommand& command) { return bus_.command(command); }
  /// The state of now.
  Status refresh();
  [[nodiscard]] Result<Known> find(const std::string& name) const;
  [[nodiscard]] const SensedObject* held(Side side) const;
  [[nodiscard]] const Pose& hand_pose(Side side) const {
    return side == Side::kLeft ? state_.pose_world_left_hand : state_.pose_world_right_hand;
  }
  /// Where the next object stands on a surface.
  [[nodiscard]] Result<Eigen::Vector3d> free_point(const SkillRequest& request,
                                                   const std::string& but) const;
  /// Moves a hand and waits for it. Returns the distance from the target at which it ends.
  Result<double> move_hand(Side side, const Pose& to, double seconds);
  Status open_and_draw_back(Side side);
  Status rest_arm(Side side);

  RobotBus& bus_;
  std::stop_token stop_;
  double speed_ = 1;
  BodyState state_;
};

}  // namespace engram::datasets::kitchen
