// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/kinematics.h"
#include "datasets/kitchen/kitchen_skills.h"
#include "datasets/kitchen/poke.h"
#include "datasets/kitchen/stance.h"

namespace engram::datasets::kitchen {

namespace {

constexpr double kRaise_m = 0.14;
constexpr double kRaised_m = 0.08;
constexpr double kStandsWithin_m = 0.04;

}  // namespace

Result<SkillResult> KitchenSkills::do_pick(const SkillRequest& request) {
  if (request.object.empty()) return invalid_argument("pick: needs an object");
  ENGRAM_ASSIGN_OR_RETURN(const Known object, find(request.object));
  const Side side = request.hand;
  if (object.type->grasp_height_m == 0)
    return invalid_argument("pick: the {} is nothing that a hand holds", object.type->spoken_name);
  if (const SensedObject* carried = held(side); carried != nullptr)
    return ended(false, fmt::format("the {} hand holds the {}", to_string(side), carried->name),
                 {});
  const Pose thing = object.sensed.pose;
  const auto surface = surface_below(thing.translation());
  const double heading = surface ? place_of(*surface).heading_rad : state_.positions[2];
  const Grasp grasp = grasp_of(*object.type, thing, side, heading);
  const Pose at = thing * grasp.pose_thing_hand;
  ENGRAM_ASSIGN_OR_RETURN([[maybe_unused]] const double looked,
                          tell(LookAt{.object = object.sensed.name, .point = {0, 0, 0}}));
  ENGRAM_RETURN_IF_ERROR(move_hand(side, before(at, side), 1.5).status());
  ENGRAM_ASSIGN_OR_RETURN(const double short_m, move_hand(side, at, 0.9));
  if (short_m > kHoldsWithin_m) {
    ENGRAM_RETURN_IF_ERROR(rest_arm(side));
    return ended(false,
                 fmt::format("the {} is {:.3f} m out of reach of the {} hand",
                             object.type->spoken_name, short_m, to_string(side)),
                 {{"out_of_reach_m", short_m}});
  }
  ENGRAM_ASSIGN_OR_RETURN(
      [[maybe_unused]] const double closed,
      tell(MoveJoints{
          .joints = hand_joints(side), .to = hand_around(grasp.width_m), .seconds = 0.5 / speed_}));
  ENGRAM_RETURN_IF_ERROR(wait(0.55));
  ENGRAM_ASSIGN_OR_RETURN(const double away_m,
                          tell(Hold{.hand = side,
                                    .object = object.sensed.name,
                                    .grasp_object = grasp.pose_thing_hand.translation()}));
  Pose up = at;
  up.translation().z() += kRaise_m;
  ENGRAM_RETURN_IF_ERROR(move_hand(side, up, 1.0).status());
  ENGRAM_ASSIGN_OR_RETURN(const Known now, find(object.sensed.name));
  const double lifted_m = now.sensed.pose.translation().z() - thing.translation().z();
  const bool has_it = now.sensed.held_by == to_string(side) && lifted_m > kRaised_m;
  const std::map<std::string, double> measured{{"lifted_m", lifted_m}, {"away_m", away_m}};
  if (!has_it) {
    ENGRAM_ASSIGN_OR_RETURN([[maybe_unused]] const double let_go, tell(Release{side}));
    ENGRAM_RETURN_IF_ERROR(open_and_draw_back(side));
    return ended(false,
                 away_m < kHoldsWithin_m
                     ? fmt::format("lifted {:.3f} m", lifted_m)
                     : fmt::format("the hand closed {:.3f} m away from its grasp", away_m),
                 measured);
  }
  ENGRAM_RETURN_IF_ERROR(
      move_hand(side, carrying_pose(state_.positions, side, hand_pose(side)), 1.2).status());
  return ended(true, fmt::format("lifted {:.3f} m", lifted_m), measured);
}

Result<SkillResult> KitchenSkills::do_place(const SkillRequest& request) {
  if (!request.surface) return invalid_argument("place: needs a surface");
  const Side side = request.hand;
  const SensedObject* carried = held(side);
  if (carried == nullptr)
    return ended(false, fmt::format("the {} hand holds nothing", to_string(side)), {});
  ENGRAM_ASSIGN_OR_RETURN(const Known object, find(carried->name));
  if (!request.object.empty() && !is_called(*object.type, request.object))
    return ended(false,
                 fmt::format("the {} hand holds the {}, not the {}", to_string(side),
                             object.type->spoken_name, request.object),
                 {});
  const auto foot = free_point(request, object.sensed.name);
  if (!foot.ok()) return ended(false, foot.status().message(), {});
  const Pose pose_thing_hand = object.sensed.pose.inverse() * hand_pose(side);
  const Pose goal =
      standing_thing(*foot, *object.type, pose_thing_hand, place_of(*request.surface).heading_rad);
  const Pose at = goal * pose_thing_hand;
  Pose above = at;
  above.translation().z() += kRaise_m;
  ENGRAM_ASSIGN_OR_RETURN([[maybe_unused]] const double looked,
                          tell(LookAt{.object = object.sensed.name, .point = {0, 0, 0}}));
  ENGRAM_RETURN_IF_ERROR(move_hand(side, above, 1.4).status());
  ENGRAM_ASSIGN_OR_RETURN(const double short_m, move_hand(side, at, 1.0));
  if (short_m > kStandsWithin_m) {
    ENGRAM_RETURN_IF_ERROR(
        move_hand(side, carrying_pose(state_.positions, side, hand_pose(side)), 1.2).status());
    return ended(
        false,
        fmt::format("its place is {:.3f} m out of reach of the {} hand", short_m, to_string(side)),
        {{"out_of_reach_m", short_m}});
  }
  ENGRAM_ASSIGN_OR_RETURN([[maybe_unused]] const double let_go, tell(Release{side}));
  ENGRAM_RETURN_IF_ERROR(open_and_draw_back(side));
  ENGRAM_ASSIGN_OR_RETURN(const Known now, find(object.sensed.name));
  const double away_m = (now.sensed.pose.translation() - goal.translation()).norm();
  const bool is_up = is_upright(now.sensed.pose);
  ENGRAM_RETURN_IF_ERROR(rest_arm(side));
  return ended(is_up && away_m < kStandsWithin_m,
               fmt::format("{} {:.3f} m from its place", is_up ? "stands" : "lies", away_m),
               {{"away_m", away_m}});
}

}  // namespace engram::datasets::kitchen
