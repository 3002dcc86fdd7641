// SPDX-License-Identifier: Apache-2.0
#include "speech/facts/known_facts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/ltm/expect_status.h"
#include "tests/speech/remembered_kitchen.h"

namespace engram::speech {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using testing::RememberedKitchen;
using testing::second;
using ::testing::SizeIs;

ltm::MemoryId thing_entity(const std::string& name) {
  return *ltm::MemoryId::parse("Objects/Instances/kitchen/" + name);
}

TEST(KnownFacts, OfAnEmptyMemoryAreNone) {
  const ScratchDirectory scratch;
  auto memory = Memory::open(scratch.path() / "empty.engram");
  ASSERT_OK(memory);
  const auto facts = KnownFacts::read(**memory);
  ASSERT_OK(facts);
  EXPECT_THAT((*facts)->executions(), IsEmpty());
  EXPECT_THAT((*facts)->world().things(), IsEmpty());
  EXPECT_EQ((*facts)->first_moment(), (*facts)->last_moment());
  // What is no record of a deed moves both.
  ASSERT_OK((*memory)->commit({{{*ltm::MemoryId::parse("RobotState/Power/robot/battery"),
                                 second(1),
                                 {{idf::Data(idf::Dict{{"charge", 0.5}}), {}}}}}}));
  ASSERT_OK((*facts)->refresh());
  EXPECT_EQ((*facts)->first_moment(), second(1));
  EXPECT_EQ((*facts)->last_moment(), second(1));
}

TEST(KnownFacts, HaveEachExecutionOnceWithItsOutcome) {
  RememberedKitchen kitchen;
  kitchen.live_one_minute();
  const auto facts = KnownFacts::read(kitchen.memory());
  ASSERT_OK(facts);
  const auto& executions = (*facts)->executions();
  ASSERT_THAT(executions, SizeIs(9));
  EXPECT_EQ(executions[0].skill, "look");
  EXPECT_EQ(executions[0].provider, "robot");
  const Execution& failed = executions[2];
  EXPECT_EQ(failed.skill, "pick");
  EXPECT_EQ(failed.outcome, ltm::ActionOutcome::kFailure);
  EXPECT_EQ(failed.hand, "right");
  EXPECT_EQ(failed.thing, thing_entity("salt_box_1"));
  EXPECT_EQ((*facts)->world().spoken(*failed.place), "counter");
  EXPECT_EQ(failed.started, second(4));
  EXPECT_EQ(failed.ended, second(8));
  EXPECT_EQ(failed.start_id.to_string(), "Skill/Event/robot/pick/2026-01-01 08:00:04.000000/0");
  EXPECT_EQ(failed.end_id->to_string(), "Skill/Event/robot/pick/2026-01-01 08:00:08.000000/0");
  EXPECT_THAT(executions[8].stopped_by, SizeIs(1));
  EXPECT_EQ((*facts)->words_at(executions[8].stopped_by[0])->text, "Stop!");
  EXPECT_THAT((*facts)->skills(), ElementsAre("look", "navigate", "pick", "place"));
  EXPECT_EQ((*facts)->plan_at(*failed.plan)->steps.size(), 5u);
  EXPECT_EQ((*facts)->last_moment(), second(60));
}

TEST(KnownFacts, FollowLinksToTheWordsThatCausedAnExecution) {
  RememberedKitchen kitchen;
  kitchen.live_one_minute();
  const auto facts = KnownFacts::read(kitchen.memory());
  ASSERT_OK(facts);
  const auto causes = (*facts)->causes_of((*facts)->executions()[1]);
  ASSERT_OK(causes);
  ASSERT_THAT(*causes, SizeIs(3));
  EXPECT_EQ((*causes)[0].id.names()[1], "ExecutionRequest");
  EXPECT_EQ((*causes)[1].says, "salt_box_1 on table");
  EXPECT_EQ((*causes)[2].says, "I need the salt on the table.");
  EXPECT_EQ((*causes)[2].speaker, "Ada");
}

TEST(KnownFacts, TakeNamesOfThingsFromTheirClasses) {
  RememberedKitchen kitchen;
  kitchen.live_one_minute();
  const auto facts = KnownFacts::read(kitchen.memory());
  ASSERT_OK(facts);
  const KnownWorld& world = (*facts)->world();
  EXPECT_THAT(world.things_called("Salt"), ElementsAre(thing_entity("salt_box_1")));
  EXPECT_THAT(world.things_called("salt box"), ElementsAre(thing_entity("salt_box_1")));
  EXPECT_EQ(world.spoken(thing_entity("red_cup_1")), "red cup");
  // There is a class of oil, and no oil.
  EXPECT_THAT(world.things_called("oil"), IsEmpty());
  EXPECT_TRUE(world.knows_thing("oil"));
  EXPECT_FALSE(world.knows_thing("elephant"));
}

TEST(KnownFacts, SayWhereThingsAndTheRobotWere) {
  RememberedKitchen kitchen;
  kitchen.live_one_minute();
  const auto facts = KnownFacts::read(kitchen.memory());
  ASSERT_OK(facts);
  const KnownWorld& world = (*facts)->world();
  const auto place_at = [&](const char* name, double at) -> std::string {
    const auto state = (*facts)->thing_at(thing_entity(name), second(at));
    const KnownPlace* place = world.under(*(*state)->spot);
    return place == nullptr ? "nowhere" : place->spoken;
  };
  EXPECT_EQ(place_at("salt_box_1", 5), "counter");
  EXPECT_EQ(place_at("salt_box_1", 59), "table");
  EXPECT_EQ(place_at("red_cup_1", 59), "table");
  const auto before = (*facts)->thing_at(thing_entity("salt_box_1"), second(-1));
  ASSERT_OK(before);
  EXPECT_FALSE(before->has_value());
  const auto states = (*facts)->things_at(second(14));
  ASSERT_OK(states);
  EXPECT_THAT(*states, SizeIs(3));
  const auto robot = (*facts)->robot_at(second(20));
  ASSERT_OK(robot);
  EXPECT_EQ(world.beside((*robot)->spot, 1.0)->spoken, "table");
  const auto way = (*facts)->way_of_robot(second(4), second(16));
  ASSERT_OK(way);
  EXPECT_NEAR((*way)->length_m, std::hypot(1.1, 0.8), 1e-5);
}

TEST(KnownFacts, FindTheFirstAndLastStateThatFits) {
  RememberedKitchen kitchen;
  kitchen.live_one_minute();
  kitchen.live_one_minute(3);
  const auto facts = KnownFacts::read(kitchen.memory());
  ASSERT_OK(facts);
  const auto is_seen = [](const ThingState& state) { return state.is_visible == true; };
  const auto last =
      (*facts)->last_state(thing_entity("salt_box_1"), Time::min(), Time::max(), is_seen);
  ASSERT_OK(last);
  EXPECT_EQ((*last)->time, second(19, 3));
  const auto first =
      (*facts)->first_state(thing_entity("salt_box_1"), second(1), Time::max(), is_seen);
  ASSERT_OK(first);
  EXPECT_EQ((*first)->time, second(13));
  const auto never =
      (*facts)->last_state(thing_entity("red_cup_1"), Time::min(), Time::max(), is_seen);
  ASSERT_OK(never);
  EXPECT_FALSE(never->has_value());
}

TEST(KnownFacts, TakeUpWhatCameSince) {
  RememberedKitchen kitchen;
  kitchen.live_one_minute();
  const auto facts = KnownFacts::read(kitchen.memory());
  ASSERT_OK(facts);
  // It began before and ends after the memory was read.
  kitchen.execute({.skill = "place", .from = 61, .is_ended = false});
  ASSERT_OK((*facts)->refresh());
  ASSERT_THAT((*facts)->executions(), SizeIs(10));
  EXPECT_EQ((*facts)->executions().back().outcome, ltm::ActionOutcome::kRunning);
  kitchen.live_one_minute(1);
  ASSERT_OK((*facts)->refresh());
  EXPECT_THAT((*facts)->executions(), SizeIs(19));
  EXPECT_THAT((*facts)->words(), SizeIs(6));
  EXPECT_EQ((*facts)->last_moment(), second(60, 1));
}

TEST(KnownFacts, LetNothingWithoutAnEndGoOnForEver) {
  RememberedKitchen kitchen;
  kitchen.execute({.skill = "pick", .from = 1, .hand = "left", .is_ended = false});
  kitchen.execute({.skill = "pick", .from = 2, .to = 4, .hand = "right"});
  kitchen.execute({.skill = "pick", .from = 5, .hand = "left", .is_ended = false});
  const auto facts = KnownFacts::read(kitchen.memory());
  ASSERT_OK(facts);
  const auto& executions = (*facts)->executions();
  ASSERT_THAT(executions, SizeIs(3));
  // Two hands do two things at a time, and one hand does not.
  EXPECT_EQ(executions[0].latest_end(), second(5));
  EXPECT_EQ(executions[1].latest_end(), second(4));
  EXPECT_EQ(executions[2].latest_end(), Time::max());
}

TEST(KnownFacts, TakeThingPlaceAndHandFromParameters) {
  RememberedKitchen kitchen;
  kitchen.live_one_minute();
  const auto entity = *ltm::MemoryId::parse("Skill/Event/kitchen/place");
  const auto commit = [&](double at, int32_t stage, int32_t outcome) {
    // As the skill memory writes it: nothing but the parameters tells what it is about.
    idf::Dict value{
        {"skill", "kitchen/place"},
        {"stage", stage},
        {"outcome", outcome},
        {"reason", "the table"},
        {"started", to_ns(second(50))},
        {"parameters", R"({"object":"Objects/Instances/kitchen/tea_box_1","surface":"table",)"
                       R"("hand":"left","speed":2.5})"}};
    ASSERT_OK(kitchen.memory().commit({{{entity, second(at), {{idf::Data(value), {}}}}}}));
  };
  commit(50, 0, 0);
  commit(52, 1, 0);
  commit(55, 2, 4);
  const auto facts = KnownFacts::read(kitchen.memory());
  ASSERT_OK(facts);
  ASSERT_THAT((*facts)->executions(), SizeIs(10));
  const Execution& execution = (*facts)->executions().back();
  EXPECT_EQ(execution.provider, "kitchen");
  EXPECT_EQ(execution.thing, thing_entity("tea_box_1"));
  ASSERT_TRUE(execution.place.has_value());
  EXPECT_EQ((*facts)->world().spoken(*execution.place), "table");
  EXPECT_EQ(execution.hand, "left");
  EXPECT_EQ(execution.ended, second(55));
  // It was lost: nobody knows how it ended.
  EXPECT_EQ(execution.outcome, ltm::ActionOutcome::kUnknown);
}

TEST(KnownFacts, AreNotMisledByHostileValues) {
  RememberedKitchen kitchen;
  kitchen.live_one_minute();
  const auto commit = [&](const char* name, idf::Dict value) {
    const auto entity = *ltm::MemoryId::parse(std::string("Skill/Event/robot/") + name);
    ASSERT_OK(
        kitchen.memory().commit({{{entity, second(58), {{idf::Data(std::move(value)), {}}}}}}));
  };
  commit("a", {{"skill", ""}, {"outcome", "wonderful"}, {"plan", "a//b"}, {"parameters", "{{{"}});
  commit("b", {{"skill", "x,y|z"},
               {"outcome", idf::List{}},
               {"stage", int32_t{99}},
               {"started", "soon"},
               {"stopped_by", "nobody"}});
  // A plan that leads to itself ends somewhere.
  const std::string self = "Tasks/Plans/robot/plan/2026-01-01 08:00:58.000000/0";
  ASSERT_OK(kitchen.memory().commit(
      {{{*ltm::MemoryId::parse("Tasks/Plans/robot/plan"),
         second(58),
         {{idf::Data(idf::Dict{{"goal", "x"}, {"steps", int32_t{3}}, {"command", self}}), {}}}}}}));
  commit("c",
         {{"skill", "robot/wave"}, {"outcome", int32_t{1}}, {"plan", self}, {"request", self}});
  const auto facts = KnownFacts::read(kitchen.memory());
  ASSERT_OK(facts);
  EXPECT_THAT((*facts)->executions(), SizeIs(12));
  for (const Execution& execution : (*facts)->executions()) {
    const auto causes = (*facts)->causes_of(execution);
    ASSERT_OK(causes);
    EXPECT_LE(causes->size(), 16u);
  }
}

TEST(KnownFacts, StandNumbersThatAreNone) {
  RememberedKitchen kitchen;
  kitchen.live_one_minute();
  const double none = std::nan("");
  const auto pose = idf::Dict{
      {std::string(idf::kPositionKey), idf::NdArray::take({3}, std::vector<double>{-1.6, 0, 0.81})},
      {std::string(idf::kOrientationKey),
       idf::NdArray::take({4}, std::vector<double>{1, 0, 0, 0})}};
  ASSERT_OK(kitchen.memory().commit(
      {{{*ltm::MemoryId::parse("Objects/Surfaces/kitchen/mist"),
         second(1),
         {{idf::Data(idf::Dict{
               {"name", "mist"}, {"pose_world_surface", pose}, {"depth", none}, {"width", none}}),
           {}}}}}}));
  // An end before its start, and a start at the end of all times.
  const auto commit = [&](const char* name, int64_t started, int64_t ended) {
    const auto entity = *ltm::MemoryId::parse(std::string("Skill/Event/robot/") + name);
    idf::Dict value{{"skill", name},
                    {"outcome", int32_t{1}},
                    {"stage", int32_t{2}},
                    {"started", started},
                    {"ended", ended}};
    ASSERT_OK(kitchen.memory().commit({{{entity, second(58), {{idf::Data(value), {}}}}}}));
  };
  commit("a", to_ns(second(57)), to_ns(second(50)));
  commit("b", std::numeric_limits<int64_t>::min(), std::numeric_limits<int64_t>::max());
  const auto facts = KnownFacts::read(kitchen.memory());
  ASSERT_OK(facts);
  const auto state = (*facts)->thing_at(thing_entity("salt_box_1"), second(59));
  ASSERT_OK(state);
  EXPECT_EQ((*facts)->world().under(*(*state)->spot)->spoken, "table");
  ASSERT_THAT((*facts)->executions(), SizeIs(11));
  EXPECT_EQ((*facts)->executions()[9].ended, second(57));
  EXPECT_EQ((*facts)->executions()[10].started, second(58));
  EXPECT_EQ((*facts)->executions()[10].ended, second(58));
}

TEST(KnownFacts, LookAtMoreThanTheFirstEntityOfAProvider) {
  RememberedKitchen kitchen;
  ASSERT_OK(
      kitchen.memory().commit({{{*ltm::MemoryId::parse("RobotState/Localization/robot/battery"),
                                 second(0),
                                 {{idf::Data(idf::Dict{{"charge", 0.5}}), {}}}}}}));
  kitchen.stand(1, 0, 0.5, 1.57);
  const auto facts = KnownFacts::read(kitchen.memory());
  ASSERT_OK(facts);
  const auto robot = (*facts)->robot_at(second(2));
  ASSERT_OK(robot);
  EXPECT_TRUE(robot->has_value());
}

TEST(KnownFacts, TakeUpWhatIsToldLaterOfEarlier) {
  RememberedKitchen kitchen;
  kitchen.execute({.skill = "pick", .from = 1, .to = 10});
  const auto facts = KnownFacts::read(kitchen.memory());
  ASSERT_OK(facts);
  // Another skill of the same provider ended before, and its events come only now.
  kitchen.execute({.skill = "look", .from = 2, .to = 3});
  ASSERT_OK((*facts)->refresh());
  ASSERT_THAT((*facts)->executions(), SizeIs(2));
  EXPECT_EQ((*facts)->executions()[1].skill, "look");
}

TEST(KnownFacts, TakeUpThatAPlaceMoved) {
  RememberedKitchen kitchen;
  const auto facts = KnownFacts::read(kitchen.memory());
  ASSERT_OK(facts);
  const Spot before{.x = 0, .y = 1.6, .z = 1};
  const Spot after{.x = 5, .y = 1.6, .z = 1};
  ASSERT_NE((*facts)->world().under(before), nullptr);
  EXPECT_EQ((*facts)->world().under(after), nullptr);
  kitchen.put_surface(20, "counter", 5, 1.6);
  ASSERT_OK((*facts)->refresh());
  EXPECT_EQ((*facts)->world().under(before), nullptr);
  ASSERT_NE((*facts)->world().under(after), nullptr);
  EXPECT_EQ((*facts)->world().under(after)->spoken, "counter");
  EXPECT_EQ((*facts)->world().places_called("counter").size(), 1u);
}

TEST(KnownFacts, HideOnlyTheRefusalsOfAnsweringItself) {
  RememberedKitchen kitchen;
  const auto refuse = [&](const char* provider) {
    const auto entity = *ltm::MemoryId::parse(std::string("Skill/Refusal/") + provider + "/answer");
    idf::Dict value{{"skill", std::string(provider) + "/answer"},
                    {"request", ""},
                    {"reason", "nobody is there"},
                    {"unmet", idf::List{}}};
    ASSERT_OK(kitchen.memory().commit({{{entity, second(3), {{idf::Data(value), {}}}}}}));
  };
  refuse("speech");
  refuse("phone");
  const auto facts = KnownFacts::read(kitchen.memory());
  ASSERT_OK(facts);
  ASSERT_THAT((*facts)->refusals(), SizeIs(1));
  EXPECT_EQ((*facts)->refusals()[0].provider, "phone");
}

TEST(KnownFacts, ReadActionsOfBeforeThereWereEvents) {
  RememberedKitchen kitchen;
  const auto entity = *ltm::MemoryId::parse("Skills/Actions/robot/pick");
  const auto commit = [&](double at, int32_t outcome) {
    idf::Dict value{{"skill", "pick"},
                    {"outcome", outcome},
                    {"reason", "lifted"},
                    {"started", to_ns(second(1))},
                    {"hand", "left"}};
    ASSERT_OK(kitchen.memory().commit({{{entity, second(at), {{idf::Data(value), {}}}}}}));
  };
  commit(1, 0);
  commit(4, 1);
  const auto facts = KnownFacts::read(kitchen.memory());
  ASSERT_OK(facts);
  ASSERT_THAT((*facts)->executions(), SizeIs(1));
  EXPECT_EQ((*facts)->executions()[0].outcome, ltm::ActionOutcome::kSuccess);
  EXPECT_EQ((*facts)->executions()[0].ended, second(4));
  EXPECT_EQ((*facts)->executions()[0].hand, "left");
}

}  // namespace
}  // namespace engram::speech
