// SPDX-License-Identifier: Apache-2.0
#include "speech/facts/facts_as_of.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/ltm/expect_status.h"
#include "tests/speech/remembered_kitchen.h"

namespace engram::speech {
namespace {

using ::testing::IsEmpty;
using testing::RememberedKitchen;
using testing::second;
using ::testing::SizeIs;

TEST(FactsAsOf, TakeTheEndFromWhatEndedLater) {
  RememberedKitchen kitchen;
  kitchen.live_one_minute();
  const auto facts = KnownFacts::read(kitchen.memory());
  ASSERT_OK(facts);
  const FactsAsOf before(**facts, second(36.2));
  ASSERT_THAT(before.executions(), SizeIs(9));
  const Execution& running = *before.executions().back();
  EXPECT_EQ(running.outcome, ltm::ActionOutcome::kRunning);
  EXPECT_FALSE(running.ended || running.end_id || running.thing_after);
  EXPECT_EQ(running.reason, "");
  EXPECT_THAT(running.stopped_by, IsEmpty());
  EXPECT_TRUE(running.plan && running.request && running.thing && running.place);
  // What ended before is as it is, and not copied.
  EXPECT_EQ(before.executions().front(), &(*facts)->executions().front());
  EXPECT_EQ((*facts)->executions().back().outcome, ltm::ActionOutcome::kStop);

  const FactsAsOf at_the_end(**facts, second(36.5));
  EXPECT_EQ(at_the_end.executions().back()->outcome, ltm::ActionOutcome::kStop);
}

TEST(FactsAsOf, HaveNothingOfLater) {
  RememberedKitchen kitchen;
  kitchen.live_one_minute();
  const auto facts = KnownFacts::read(kitchen.memory());
  ASSERT_OK(facts);
  FactsAsOf early(**facts, second(10));
  EXPECT_THAT(early.executions(), SizeIs(4));
  EXPECT_THAT(early.words(), SizeIs(1));
  EXPECT_THAT(early.plans(), SizeIs(1));
  EXPECT_EQ(early.plan_at((*facts)->plans()[1].id), nullptr);
  EXPECT_EQ(early.words_at((*facts)->words()[1].id), nullptr);
  EXPECT_NE(early.words_at((*facts)->words()[0].id), nullptr);
  const auto states = early.things_at(second(60));
  ASSERT_OK(states);
  for (const ThingState& state : *states) EXPECT_EQ(state.time, second(0));
  const auto robot = early.robot_at(Time::max());
  ASSERT_OK(robot);
  EXPECT_EQ((*robot)->time, second(4));
  const auto way = early.way_of_robot(second(0), second(60));
  ASSERT_OK(way);
  for (const ltm::MemoryId& end : (*way)->ends) EXPECT_TRUE(early.has(end));

  const FactsAsOf before_all(**facts, second(-1));
  EXPECT_THAT(before_all.executions(), IsEmpty());
  EXPECT_TRUE(before_all.words().empty());
}

TEST(FactsAsOf, KnowNoMemberThatALaterEventTold) {
  RememberedKitchen kitchen;
  const auto entity = *ltm::MemoryId::parse("Skill/Event/robot/pick");
  const std::string salt = "Objects/Instances/kitchen/salt_box_1";
  kitchen.see(0, "salt_box_1", 0.5, 1.5, 0.97, true);
  const std::string words = kitchen.say(0.5, "Ada", "I need the salt.");
  const std::string plan = kitchen.plan(0.5, "salt_box_1", "counter", "table", words);
  const auto tell = [&](double at, int32_t stage, idf::Dict members) {
    members.set("skill", "robot/pick");
    members.set("stage", stage);
    members.set("outcome", int32_t{stage == 2});
    members.set("started", to_ns(second(1)));
    ASSERT_OK(kitchen.memory().commit({{{entity, second(at), {{idf::Data(members), {}}}}}}));
  };
  tell(1, 0, {{"hand", "left"}});
  tell(3, 1, {{"object", salt}});
  tell(5, 2, {{"plan", plan}, {"surface", "Objects/Surfaces/kitchen/counter"}});
  const auto facts = KnownFacts::read(kitchen.memory());
  ASSERT_OK(facts);
  const FactsAsOf early(**facts, second(2));
  EXPECT_EQ(early.executions().at(0)->hand, "left");
  EXPECT_FALSE(early.executions().at(0)->thing);
  // It runs still, and by now it was told with what.
  const FactsAsOf amid(**facts, second(4));
  EXPECT_TRUE(amid.executions().at(0)->thing);
  EXPECT_FALSE(amid.executions().at(0)->plan || amid.executions().at(0)->place);
  const FactsAsOf late(**facts, second(5));
  EXPECT_TRUE(late.executions().at(0)->plan && late.executions().at(0)->place);
}

TEST(FactsAsOf, KnowAnEndOnlyWhenItIsTold) {
  RememberedKitchen kitchen;
  const auto entity = *ltm::MemoryId::parse("Skill/Event/robot/pick");
  const auto tell = [&](double at, int32_t stage, int32_t outcome) {
    idf::Dict value{{"skill", "robot/pick"},       {"stage", stage},
                    {"outcome", outcome},          {"reason", ""},
                    {"started", to_ns(second(1))}, {"ended", to_ns(second(5))}};
    ASSERT_OK(kitchen.memory().commit({{{entity, second(at), {{idf::Data(value), {}}}}}}));
  };
  tell(2, 0, 0);
  tell(9, 2, 1);
  const auto facts = KnownFacts::read(kitchen.memory());
  ASSERT_OK(facts);
  EXPECT_THAT(FactsAsOf(**facts, second(1.5)).executions(), IsEmpty());
  EXPECT_FALSE(FactsAsOf(**facts, second(6)).executions().at(0)->ended.has_value());
  EXPECT_EQ(FactsAsOf(**facts, second(9)).executions().at(0)->ended, second(5));
}

}  // namespace
}  // namespace engram::speech
