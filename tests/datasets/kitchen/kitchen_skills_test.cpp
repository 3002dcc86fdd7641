// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/kitchen_skills.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/kitchen/live_body.h"
#include "tests/ltm/expect_status.h"

namespace engram::datasets::kitchen {
namespace {

using ::testing::HasSubstr;

/// Requests a stop once a hand was told to move for some samples.
class StoppingBus final : public RobotBus {
 public:
  StoppingBus(RobotBus& bus, std::stop_source& stop, uint64_t after)
      : bus_(bus), stop_(stop), after_(after) {}

  Result<BodyDescription> describe() override { return bus_.describe(); }
  Result<std::vector<BodyState>> wait(uint64_t until, const std::stop_token& stop) override {
    auto states = bus_.wait(until, stop);
    if (states.ok() && begin_ && states->back().sample >= *begin_ + after_) stop_.request_stop();
    if (states.ok()) now_ = states->back().sample;
    return states;
  }
  Result<BodyState> now() override { return bus_.now(); }
  Result<BodyPicture> draw(uint64_t until, uint64_t done, const std::stop_token& stop) override {
    return bus_.draw(until, done, stop);
  }
  Result<double> command(const BodyCommand& command) override {
    const bool moves =
        std::holds_alternative<MoveHand>(command) || std::holds_alternative<DriveTo>(command);
    if (moves && !begin_) begin_ = now_;
    return bus_.command(command);
  }
  Result<std::string> poke(const std::string& what) override { return bus_.poke(what); }

 private:
  RobotBus& bus_;
  std::stop_source& stop_;
  uint64_t after_;
  uint64_t now_ = 0;
  std::optional<uint64_t> begin_;
};

class Skills : public ::testing::Test {
 protected:
  Skills() {
    LiveBody::Options options;
    options.kitchen = KitchenOptions::fast();
    options.kitchen.width = options.kitchen.height = 32;
    options.is_stepped = true;
    options.clients = {"skills"};
    auto body = LiveBody::start(options);
    EXPECT_OK(body);
    body_ = std::move(*body);
    bus_ = body_->bus("skills");
  }

  BodyState state() { return bus_->now().value(); }

  /// A thing that stands on the counter.
  std::string on_counter() {
    for (const SensedObject& object : state().objects)
      if (class_named(object.name)->grasp_height_m > 0 &&
          surface_below(object.pose.translation()) == Surface::kCounter)
        return object.name;
    ADD_FAILURE() << "nothing on the counter";
    return "";
  }

  std::string held_by(const std::string& thing) {
    for (const SensedObject& object : state().objects)
      if (object.name == thing) return object.held_by;
    ADD_FAILURE() << thing;
    return "";
  }

  std::unique_ptr<LiveBody> body_;
  std::unique_ptr<RobotBus> bus_;
};

TEST_F(Skills, CarryAThingFromTheCounterToTheTable) {
  KitchenSkills skills(*bus_);
  const SkillRequest thing{.object = on_counter()};
  const auto driven = skills.navigate(thing, {});
  ASSERT_OK(driven);
  EXPECT_EQ(driven->end, SkillEnd::kSuccess) << driven->reason;
  EXPECT_LT(driven->measured.at("error_m"), 0.03);
  const auto seen = skills.look(thing, {});
  ASSERT_OK(seen);
  EXPECT_EQ(seen->end, SkillEnd::kSuccess) << seen->reason;
  const auto picked = skills.pick(thing, {});
  ASSERT_OK(picked);
  ASSERT_EQ(picked->end, SkillEnd::kSuccess) << picked->reason;
  EXPECT_GT(picked->measured.at("lifted_m"), 0.08);
  const SkillRequest table{.object = {}, .surface = Surface::kTable};
  const auto carried = skills.navigate(table, {});
  ASSERT_OK(carried);
  EXPECT_EQ(carried->end, SkillEnd::kSuccess) << carried->reason;
  const auto placed = skills.place(table, {});
  ASSERT_OK(placed);
  EXPECT_EQ(placed->end, SkillEnd::kSuccess) << placed->reason;
  EXPECT_THAT(placed->reason, HasSubstr("stands 0.0"));
  for (const SensedObject& object : state().objects)
    if (object.name == thing.object) {
      EXPECT_EQ(object.held_by, "");
      EXPECT_EQ(surface_below(object.pose.translation()), Surface::kTable);
    }
}

TEST_F(Skills, RestSoonAfterAStop) {
  const SkillRequest thing{.object = on_counter()};
  ASSERT_OK(KitchenSkills(*bus_).navigate(thing, {}));
  std::stop_source stop;
  StoppingBus bus(*bus_, stop, 60);
  const uint64_t begin = state().sample;
  const auto picked = KitchenSkills(bus).pick(thing, stop.get_token());
  ASSERT_OK(picked);
  EXPECT_EQ(picked->end, SkillEnd::kStop);
  EXPECT_EQ(picked->reason, "told to stop");
  const BodyState rest = state();
  EXPECT_LE(rest.sample, begin + 60 + 41);
  // The neck still follows what the cameras look at.
  RobotVector moves = rest.velocities;
  moves[joint_index("neck_yaw")] = moves[joint_index("neck_pitch")] = 0;
  EXPECT_LT(moves.cwiseAbs().maxCoeff(), 0.02);
  EXPECT_EQ(held_by(thing.object), "") << "it was stopped on its way";

  // What the hand holds stays in it.
  const auto held = KitchenSkills(*bus_).pick(thing, {});
  ASSERT_OK(held);
  ASSERT_EQ(held->end, SkillEnd::kSuccess) << held->reason;

  std::stop_source again;
  StoppingBus drive(*bus_, again, 80);
  const auto driven =
      KitchenSkills(drive).navigate({.object = {}, .surface = Surface::kTable}, again.get_token());
  ASSERT_OK(driven);
  EXPECT_EQ(driven->end, SkillEnd::kStop);
  EXPECT_LT(state().velocities.head<3>().cwiseAbs().maxCoeff(), 0.02);
  EXPECT_EQ(held_by(thing.object), "right");
}

TEST_F(Skills, FailWithTheirReasons) {
  KitchenSkills skills(*bus_);
  const std::string thing = on_counter();
  ASSERT_OK(skills.navigate({.object = {}, .surface = Surface::kTable}, {}));
  const auto far = skills.pick({.object = thing}, {});
  ASSERT_OK(far);
  EXPECT_EQ(far->end, SkillEnd::kFailure);
  EXPECT_THAT(far->reason, HasSubstr("out of reach of the right hand"));
  EXPECT_GT(far->measured.at("out_of_reach_m"), 0.1);
  const auto nothing = skills.place({.object = {}, .surface = Surface::kTable}, {});
  ASSERT_OK(nothing);
  EXPECT_EQ(nothing->reason, "the right hand holds nothing");
  EXPECT_FAILS(skills.pick({.object = "dog"}, {}), StatusCode::kNotFound, "has no 'dog'; it has");
  EXPECT_FAILS(skills.pick({.object = "chair"}, {}), StatusCode::kInvalidArgument,
               "nothing that a hand holds");
  EXPECT_FAILS(skills.place({}, {}), StatusCode::kInvalidArgument, "needs a surface");
  EXPECT_FAILS(skills.navigate({}, {}), StatusCode::kInvalidArgument, "needs an object");
  EXPECT_FAILS(skills.look({.object = thing, .speed = 0}, {}), StatusCode::kInvalidArgument,
               "speed 0");

  // A person stands between the table and the counter.
  ASSERT_OK(bus_->poke("person to -0.45,0.5"));
  const auto blocked = skills.navigate({.object = {}, .place = Eigen::Vector3d(0.2, 0.7, 0)}, {});
  ASSERT_OK(blocked);
  EXPECT_EQ(blocked->end, SkillEnd::kFailure);
  EXPECT_THAT(blocked->reason, HasSubstr("the person stands in the way"));
}

}  // namespace
}  // namespace engram::datasets::kitchen
