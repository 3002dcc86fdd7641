// SPDX-License-Identifier: Apache-2.0
#include "speech/program/execute.h"

#include <gtest/gtest.h>

#include "tests/speech/program/executing.h"

namespace engram::speech {
namespace {

using testing::Executing;
using testing::second;

TEST_F(Executing, SelectsAndFilters) {
  EXPECT_EQ(value_of("executions | count"), "9");
  EXPECT_EQ(value_of("executions skill=pick thing=salt | count"), "2");
  EXPECT_EQ(value_of("executions skill=robot/pick | count"), "3");
  EXPECT_EQ(value_of("executions skill=pick,place | count"), "4");
  EXPECT_EQ(value_of("executions outcome=problem | count"), "2");
  EXPECT_EQ(value_of("executions hand=left | count"), "1");
  EXPECT_EQ(value_of("executions place=table skill=navigate | count"), "1");
  EXPECT_EQ(value_of("executions speaker=ben | count"), "3");
  EXPECT_EQ(value_of("executions thing=Objects/Instances/kitchen/tea_box_1 | count"), "3");
  EXPECT_EQ(value_of("executions skill=pick | first | events"),
            R"(["Skill/Event/robot/pick/2026-01-01 08:00:04.000000/0"])");
  EXPECT_EQ(value_of("executions skill=pick | nth=2 | which=hand"), R"(["right"])");
  EXPECT_EQ(value_of("executions skill=pick | which=thing"), R"(["salt","tea"])");
  EXPECT_EQ(value_of("executions | longest | which=skill"), R"(["pick"])");
}

TEST_F(Executing, TellsWhatWasMoved) {
  const Outcome moved = outcome_of("things thing=salt | was_moved");
  EXPECT_EQ(moved.value, AnswerValue(answers::YesNo{true}));
  ASSERT_EQ(moved.evidence.size(), 2u);
  EXPECT_EQ(moved.evidence[0].id.time(), second(0));
  EXPECT_EQ(moved.evidence[1].id.time(), second(60));
  EXPECT_EQ(value_of("things thing=tea | was_moved"), "false");
  EXPECT_EQ(value_of("things thing=juice | was_moved"), "unknown: no thing is called juice");
  // Before it was moved, and after it.
  EXPECT_EQ(value_of("things thing=salt before=08:00:10 | was_moved"), "false");
  EXPECT_EQ(value_of("things thing=salt after=08:00:20 | was_moved"), "false");
  now_ = second(10);
  EXPECT_EQ(value_of("things thing=salt | was_moved"), "false");
}

TEST_F(Executing, TellsColoursStepsAndTheSameHand) {
  EXPECT_EQ(value_of("things thing=salt | which=colour"), R"(["white"])");
  EXPECT_EQ(value_of("things thing=tea | which=colour"), "unknown: no colour is told of it");
  EXPECT_EQ(value_of("plans | last | which=skill"), R"(["look","navigate","pick","place"])");
  EXPECT_EQ(value_of("plans | last | how_many=step"), "5");
  EXPECT_EQ(value_of("plans | how_many=step"), "10");
  constexpr const char* kHands =
      "executions skill=pick thing=salt | last | which=hand | equals=(executions skill=pick "
      "thing={} "
      "| last | which=hand)";
  EXPECT_EQ(value_of(fmt::format(kHands, "tea")), "false");
  EXPECT_EQ(value_of(fmt::format(kHands, "salt")), "true");
}

TEST_F(Executing, KeepsToTimes) {
  EXPECT_EQ(value_of("executions during=last:30s | count"), "3");
  EXPECT_EQ(value_of("executions at=08:00:05 | which=skill"), R"(["pick"])");
  EXPECT_EQ(value_of("executions during=08:00:00..08:00:05 | count"), "3");
  EXPECT_EQ(
      value_of("executions skill=navigate after=(executions skill=place | last | ended) | count"),
      "1");
  EXPECT_EQ(value_of("executions before=08:00:09 | count"), "3");
  // Nothing after the moment of the question is known then.
  now_ = second(10);
  EXPECT_EQ(value_of("executions | count"), "4");
  EXPECT_EQ(value_of("executions | last | next | when"), "unknown: nothing was done after it");
}

TEST_F(Executing, TellsWhenAndHowLong) {
  EXPECT_EQ(value_of("executions skill=place | last | when"), R"("2026-01-01 08:00:16.000000")");
  EXPECT_EQ(value_of("executions skill=place | last | ended"), R"("2026-01-01 08:00:19.000000")");
  EXPECT_EQ(value_of("executions skill=place | last | how_long"), "3.0");
  EXPECT_EQ(
      value_of("executions skill=place | span"),
      R"({"kind":"span","from":"2026-01-01 08:00:16.000000","to":"2026-01-01 08:00:19.000000"})");
  const Outcome way = outcome_of("executions skill=navigate speaker=Ada | how_far");
  ASSERT_EQ(kind_of(way.value), "metres");
  EXPECT_NEAR(std::get<answers::Metres>(way.value).value, 0.5 + std::hypot(1.1, 0.8), 1e-5);
}

TEST_F(Executing, FollowsLinks) {
  EXPECT_EQ(value_of("executions skill=navigate place=table | last | why"),
            R"("Ada said: I need the salt on the table.")");
  EXPECT_EQ(value_of("executions outcome=failure | last | reason"),
            R"("the hand closed 0.070 m away from its grasp")");
  EXPECT_EQ(value_of("executions outcome=stop | last | reason"),
            R"("told to stop; Ben said: Stop!")");
  EXPECT_EQ(value_of("executions outcome=stop | who_stopped"), R"(["Ben"])");
  EXPECT_EQ(value_of("executions skill=place | last | who"), R"(["Ada"])");
  EXPECT_EQ(value_of("plans thing=tea | said"), R"("Please bring the tea to the table.")");
  EXPECT_EQ(value_of("executions outcome=failure | last | retried"), "true");
  EXPECT_EQ(value_of("executions outcome=stop | last | retried"), "false");
  const Outcome why = outcome_of("executions skill=navigate place=table | last | why");
  EXPECT_EQ(std::get<answers::Reason>(why.value).links.size(), 3u);
}

TEST_F(Executing, TellsWhatWouldHaveBeenDone) {
  EXPECT_EQ(value_of("executions outcome=stop | last | instead"), R"(["navigate","place"])");
  // The attempt that failed was tried again, and what came after it is left all the same.
  EXPECT_EQ(value_of("executions outcome=failure | last | instead"), R"(["navigate","place"])");
  EXPECT_EQ(value_of("executions skill=place | last | instead"),
            "unknown: its plan had no further step");
}

TEST_F(Executing, TellsOneOfTheStepsThatWereLeft) {
  EXPECT_EQ(value_of("executions outcome=stop | last | instead_next"), R"(["navigate"])");
  EXPECT_EQ(value_of("executions outcome=stop | last | instead_where"), R"(["table"])");
  EXPECT_EQ(value_of("executions outcome=stop | last | instead_has=place"), "true");
  EXPECT_EQ(value_of("executions outcome=stop | last | instead_has=look"), "false");
}

TEST_F(Executing, TellsHowLongAgoAndHowManyDifferentThings) {
  EXPECT_EQ(value_of("executions skill=place | last | ago"), "44.0");
  EXPECT_EQ(value_of("executions | how_many=thing"), "2");
  EXPECT_EQ(value_of("executions outcome=failure thing=tea | none"), "true");
  EXPECT_EQ(value_of("executions outcome=failure | none"), "false");
  EXPECT_EQ(value_of("robot place=table at=08:00:20 | exists"), "true");
  EXPECT_EQ(value_of("robot place=counter at=08:00:20 | exists"), "false");
}

TEST_F(Executing, GoesToWhatWasDoneBeside) {
  EXPECT_EQ(value_of("executions skill=place | last | previous | which=skill"), R"(["navigate"])");
  EXPECT_EQ(value_of("executions skill=place | last | next | which=thing"), R"(["tea"])");
  EXPECT_EQ(value_of("executions | first | previous | when"),
            "unknown: nothing was done before it");
}

TEST_F(Executing, SaysWhereThingsAre) {
  EXPECT_EQ(value_of("things thing=salt | where"), R"(["table"])");
  EXPECT_EQ(value_of("things thing=salt at=08:00:05 | where"), R"(["counter"])");
  EXPECT_EQ(value_of("things thing=salt at=08:00:14 | where"), R"(["right hand"])");
  EXPECT_EQ(value_of("things thing=salt at=08:00:14 | holder"), R"(["right"])");
  EXPECT_EQ(value_of("things thing=salt | holder"), "[]");
  EXPECT_EQ(value_of("things place=table | which=thing"), R"(["red cup","salt"])");
  EXPECT_EQ(value_of("things held=yes at=08:00:14 | which=thing"), R"(["salt"])");
  EXPECT_EQ(value_of("things thing=salt | is_visible"), "false");
  EXPECT_EQ(value_of("things thing=salt | last_seen | when"), R"("2026-01-01 08:00:19.000000")");
  EXPECT_EQ(value_of("things thing=tea | last_seen | where"), R"(["counter"])");
  EXPECT_EQ(value_of("things thing=\"red cup\" | last_seen | where"),
            "unknown: it was never in sight");
  EXPECT_EQ(value_of("things during=today | which=thing"), R"(["salt","tea"])");
  EXPECT_EQ(value_of("robot at=08:00:20 | where"), R"(["table"])");
  EXPECT_EQ(value_of("robot at=07:00:00 | where"),
            "unknown: the memory has no place of the robot then");
}

TEST_F(Executing, FromWhereThingsWereTaken) {
  EXPECT_EQ(value_of("executions skill=pick thing=salt | last | from"), R"(["counter"])");
  EXPECT_EQ(value_of("executions skill=navigate place=table | last | from"), R"(["counter"])");
}

TEST_F(Executing, Compares) {
  EXPECT_EQ(value_of("executions skill=pick thing=salt | last | how_long | more_than=(executions "
                     "skill=pick thing=tea | last | how_long)"),
            "true");
  EXPECT_EQ(value_of("executions skill=pick thing=salt | first | when | more_than=(executions "
                     "skill=pick thing=tea | first | when)"),
            "false");
  EXPECT_EQ(value_of("executions skill=pick | count | equals=(executions skill=navigate | count)"),
            "true");
}

TEST_F(Executing, KnowsWhatWasInSightInASpan) {
  // Both were in sight in the first half minute, and now neither is.
  EXPECT_EQ(value_of("things during=today visible=yes | which=thing"), R"(["salt","tea"])");
  EXPECT_EQ(value_of("things during=today thing=salt | is_visible"), "true");
  EXPECT_EQ(value_of("things during=today visible=no | which=thing"), R"(["red cup"])");
  EXPECT_EQ(value_of("things thing=salt | is_visible"), "false");
}

TEST_F(Executing, WidensOnlyTimesOfAClock) {
  kitchen_.execute({.skill = "wipe", .from = 40, .to = 41});
  kitchen_.say(41.4, "Ada", "Thank you.");
  ASSERT_OK(facts_->refresh());
  EXPECT_EQ(value_of("words at=08:00:41 | exists"), "true");
  EXPECT_EQ(value_of("words at=(executions skill=wipe | last | ended) | exists"), "false");
}

TEST_F(Executing, TellsWhoSaidItWithoutAName) {
  const std::string stop = kitchen_.say(51, "", "Stop!");
  kitchen_.execute({.skill = "wipe", .from = 50, .to = 52, .outcome = 3, .stopped_by = stop});
  ASSERT_OK(facts_->refresh());
  EXPECT_EQ(value_of("executions skill=wipe | last | reason"), R"("somebody said: Stop!")");
}

TEST_F(Executing, FindsWordsWithinTheSecondOfAClock) {
  kitchen_.say(40.3, "Ada", "Thank you.");
  ASSERT_OK(facts_->refresh());
  EXPECT_EQ(value_of("words at=08:00:40 | said"), R"("Thank you.")");
  EXPECT_EQ(value_of("words during=08:00:40 | exists"), "true");
  EXPECT_EQ(value_of("words at=08:00:41 | exists"), "false");
}

TEST_F(Executing, TellsOneOfTwoThatFollowEachOther) {
  EXPECT_EQ(value_of("executions at=08:00:16 | which=skill"), R"(["place"])");
  EXPECT_EQ(value_of("executions at=08:00:19 | events"), "[]");
  now_ = second(36.5);
  EXPECT_EQ(value_of("executions at=now | events"), "[]");
}

TEST_F(Executing, TellsTwoExecutionsThatRunInParallel) {
  kitchen_.execute({.skill = "wipe", .from = 40, .to = 50, .hand = "left"});
  kitchen_.execute({.skill = "pour", .from = 40, .to = 45, .outcome = 2, .hand = "right"});
  kitchen_.execute({.skill = "pour", .from = 42, .to = 44, .hand = "left"});
  ASSERT_OK(facts_->refresh());
  EXPECT_EQ(value_of("executions at=08:00:43 | which=skill"), R"(["pour","wipe"])");
  EXPECT_EQ(value_of("executions at=08:00:43 | how_many=hand"), "2");
  EXPECT_EQ(
      value_of("executions at=08:00:43 | span"),
      R"({"kind":"span","from":"2026-01-01 08:00:40.000000","to":"2026-01-01 08:00:50.000000"})");
  // What began while it ran is no second attempt.
  EXPECT_EQ(value_of("executions skill=pour | first | retried"), "false");
  kitchen_.execute({.skill = "pour", .from = 46, .to = 47, .hand = "left"});
  ASSERT_OK(facts_->refresh());
  EXPECT_EQ(value_of("executions skill=pour | first | retried"), "true");
}

}  // namespace
}  // namespace engram::speech
