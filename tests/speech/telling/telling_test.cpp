// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "speech/program/execute.h"
#include "speech/telling/phrases.h"
#include "speech/telling/tell_outcome.h"
#include "speech/telling/tell_period.h"
#include "tests/speech/known_kitchen.h"

namespace engram::speech {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::second;
using ::testing::SizeIs;

class Telling : public testing::KnownKitchen {
 protected:
  std::string told(const std::string& text, Time now = second(60)) {
    const auto program = Program::parse(text);
    EXPECT_OK(program);
    const auto outcome = execute(*program, *facts_, now, DayZone::kUtc);
    EXPECT_OK(outcome);
    return tell(*outcome, *facts_, DayZone::kUtc);
  }
};

TEST_F(Telling, SaysColoursPlansAndWhatWasMoved) {
  EXPECT_EQ(told("things thing=salt | which=colour"), "The salt is white.");
  EXPECT_EQ(told("things thing=salt | was_moved"),
            "Yes. At 08:00:00 the salt was on the counter, and at 08:01:00 on the table.");
  EXPECT_EQ(told("things thing=tea | was_moved"), "No. At 08:01:00 the tea was on the counter.");
  EXPECT_THAT(told("plans | last | which=skill"),
              HasSubstr("My plan was to look for the tea, drive to the counter for the tea, "));
  EXPECT_EQ(told("plans | last | how_many=step"), "5 steps.");
}

TEST_F(Telling, SaysWhatWasDoneAndHowItEnded) {
  EXPECT_EQ(told("executions skill=pick | first | events"),
            "At 08:00:04 I tried to pick up the salt from the counter with my right hand, but "
            "failed: the hand closed 0.070 m away from its grasp.");
  EXPECT_EQ(told("executions skill=place | last | when"),
            "At 08:00:16 I placed the salt on the table with my right hand.");
  EXPECT_THAT(told("executions | events"),
              HasSubstr("I carried out 9 actions: I drove for the salt (2 times), drove for the "
                        "tea, looked for the salt, looked for the tea, picked up the salt (2 "
                        "times), picked up the tea and placed the salt. 7 succeeded, 1 failed, 1 "
                        "was stopped."));
}

TEST_F(Telling, SaysEachKindOfValue) {
  EXPECT_EQ(told("executions skill=place | last | how_long"),
            "It took 3 seconds to place the salt on the table with my right hand.");
  EXPECT_EQ(told("things thing=salt | where"), "At 08:01:00 the salt was on the table.");
  EXPECT_EQ(told("things place=table | which=thing"), "The red cup and the salt.");
  EXPECT_EQ(told("executions skill=place | last | which=hand"), "My right hand.");
  EXPECT_EQ(told("robot at=08:00:20 | where"), "I was at the table.");
  EXPECT_EQ(told("executions skill=navigate place=table | last | why"),
            "Because Ada said: \"I need the salt on the table.\"");
  EXPECT_EQ(told("executions outcome=stop | last | instead"),
            "By my plan I would have gone on to drive to the table for the tea and place the tea "
            "on the table.");
  EXPECT_THAT(told("executions skill=pick thing=salt | count"), HasSubstr("Twice. At 08:00:04 I"));
  EXPECT_EQ(told("things thing=salt place=counter | exists"),
            "No. At 08:01:00 the salt was on the table.");
  EXPECT_EQ(told("words speaker=ada | exists"), "Yes. Ada said: \"I need the salt on the table.\"");
  EXPECT_EQ(told("executions skill=pick thing=\"red cup\" | exists"),
            "No. I remember no executions of pick of the red cup.");
}

TEST_F(Telling, NamesHandsAsTheyAre) {
  EXPECT_EQ(my_hands({"right"}), "my right hand");
  EXPECT_EQ(my_hands({"left", "Right_Hand"}), "my left and right hands");
  EXPECT_EQ(my_hands({"gripper"}), "my gripper");
  kitchen_.see(58, "tea_box_1", 0, 0, 1, true, "Left_Hand");
  EXPECT_EQ(told("things held=yes hand=left at=08:00:59 | which=thing"), "The tea.");
  EXPECT_EQ(told("things thing=tea at=08:00:59 | holder"), "My left hand.");
}

TEST_F(Telling, TellsWhatGoesOn) {
  EXPECT_EQ(told("executions at=now | events", second(7)),
            "Since 08:00:04 I am picking up the salt from the counter with my right hand.");
  EXPECT_EQ(told("executions at=08:00:07 | events"),
            "At 08:00:04 I tried to pick up the salt from the counter with my right hand, but "
            "failed: the hand closed 0.070 m away from its grasp.");
}

TEST_F(Telling, TellsSinceWhenEachThingGoesOn) {
  kitchen_.execute({.skill = "wipe", .from = 50, .hand = "left", .is_ended = false});
  kitchen_.execute({.skill = "pour", .from = 55, .hand = "right", .is_ended = false});
  ASSERT_OK(facts_->refresh());
  EXPECT_EQ(told("executions at=now | events"),
            "Since 08:00:50 I am wiping with my left hand and since 08:00:55 I am pouring with my "
            "right hand.");
}

TEST_F(Telling, DoesNotPutAThingWhereItIsNot) {
  kitchen_.see(58, "tea_box_1", 3, 3, 0.02, true);
  EXPECT_EQ(told("things thing=tea place=counter at=08:00:59 | exists"),
            "No. At 08:00:58 the tea was at x 3.00 m, y 3.00 m.");
}

TEST_F(Telling, SaysSomebodyWhereNobodyIsNamed) {
  const std::string stop = kitchen_.say(1, "", "Stop!", 3);
  kitchen_.execute(
      {.skill = "wipe", .from = 0, .to = 2, .outcome = 3, .stopped_by = stop, .day = 3});
  ASSERT_OK(facts_->refresh());
  const auto narration =
      tell_period(*facts_, {second(0, 3), second(60, 3)}, second(60, 3), DayZone::kUtc);
  ASSERT_OK(narration);
  EXPECT_EQ(narration->back().text,
            "At 08:00:00 I began to wipe, but was stopped (somebody said: \"Stop!\").");
}

TEST_F(Telling, CountsDifferentThings) {
  EXPECT_EQ(told("executions skill=pick,place speaker=ada outcome=success | how_many=thing"),
            "1 thing. At 08:00:09 I picked up the salt from the counter with my right hand. At "
            "08:00:16 I placed the salt on the table with my right hand.");
  EXPECT_EQ(told("plans | how_many=thing"), "2 things.");
}

TEST_F(Telling, TellsTheWholeTimeOfWhatRunsInParallel) {
  kitchen_.execute({.skill = "wipe", .from = 1, .to = 20, .day = 3});
  kitchen_.execute({.skill = "look", .from = 2, .to = 3, .day = 3});
  kitchen_.execute({.skill = "pour", .from = 4, .to = 30, .outcome = 4, .day = 3});
  ASSERT_OK(facts_->refresh());
  const auto narration =
      tell_period(*facts_, {second(0, 3), second(60, 3)}, second(60, 3), DayZone::kUtc);
  ASSERT_OK(narration);
  ASSERT_THAT(*narration, SizeIs(3));
  EXPECT_EQ((*narration)[0].text,
            "From 08:00:01 to 08:00:30 I carried out 3 actions; of 1 no end is known.");
  EXPECT_EQ((*narration)[2].text, "At 08:00:04 I began to pour, and nobody knows how it ended.");
}

TEST_F(Telling, SaysThatThereWasNothing) {
  EXPECT_EQ(told("executions at=now | events"), "I was doing nothing.");
  EXPECT_EQ(told("executions skill=place place=counter | events"),
            "Nothing. I remember no executions of place at the counter.");
  EXPECT_EQ(told("executions skill=navigate thing=\"red cup\" | which=place"),
            "Nowhere. I remember no executions of navigate of the red cup.");
  EXPECT_EQ(told("things held=yes | which=thing"), "Nothing.");
  EXPECT_EQ(told("things thing=salt | holder"),
            "Nothing does. At 08:01:00 the salt was on the table.");
  // What was seen long ago is told with its time.
  EXPECT_EQ(told("things held=yes | which=thing", second(7200)),
            "Nothing, as I saw it at 08:01:00.");
}

TEST_F(Telling, SaysWhatItDoesNotKnow) {
  EXPECT_EQ(told("executions thing=elephant | count"),
            "I do not know: no thing is called elephant. I looked for executions of the elephant.");
}

TEST_F(Telling, TellsATimeByPlansWithWhatFailed) {
  const auto narration = tell_period(*facts_, {second(0), second(60)}, second(60), DayZone::kUtc);
  ASSERT_OK(narration);
  std::string text;
  for (const NarrationSentence& one : *narration) {
    text += std::string(name_of(one.level)) + ": " + one.text + "\n";
    EXPECT_THAT(one.links, Not(IsEmpty())) << one.text;
    for (const ltm::MemoryId& id : one.links) EXPECT_OK(facts_->value_at(id));
  }
  EXPECT_EQ(text,
            "whole: From 08:00:01 to 08:00:36 I carried out 9 actions for 2 tasks; 1 failed "
            "and 1 was stopped.\n"
            "plan: At 08:00:01 Ada said: \"I need the salt on the table.\" So I looked for the "
            "salt, drove to the counter for the salt, picked up the salt from the counter, drove "
            "to the table for the salt and placed the salt on the table.\n"
            "failure: At 08:00:04 I tried to pick up the salt from the counter with my right hand, "
            "but failed: the hand closed 0.070 m away from its grasp.\n"
            "plan: At 08:00:30 Ben said: \"Please bring the tea to the table.\" So I looked for "
            "the tea and drove to the counter for the tea.\n"
            "failure: At 08:00:34 I began to pick up the tea from the counter with my left hand, "
            "but was stopped: told to stop (Ben said: \"Stop!\").\n");
}

TEST_F(Telling, TellsNothingThatCameLater) {
  const auto narration = tell_period(*facts_, {second(0), second(60)}, second(7.9), DayZone::kUtc);
  ASSERT_OK(narration);
  ASSERT_THAT(*narration, SizeIs(3));
  EXPECT_EQ((*narration)[0].text,
            "From 08:00:01 to 08:00:04 I carried out 3 actions for 1 task; of 1 no end is known.");
  EXPECT_EQ((*narration)[2].text,
            "At 08:00:04 I began to pick up the salt from the counter with my right hand, and no "
            "end is known.");
  for (const NarrationSentence& one : *narration)
    for (const ltm::MemoryId& id : one.links) EXPECT_LE(*id.time(), second(7.9));
}

TEST_F(Telling, KeepsToTheNumberOfSentences) {
  for (int day = 1; day < 12; ++day) kitchen_.live_one_minute(day);
  ASSERT_OK(facts_->refresh());
  for (const size_t max : {1u, 2u, 3u, 5u, 10u}) {
    const auto narration =
        tell_period(*facts_, {Time::min(), Time::max()}, second(60, 12), DayZone::kUtc, max);
    ASSERT_OK(narration);
    EXPECT_THAT(*narration, SizeIs(max));
  }
  const auto nothing =
      tell_period(*facts_, {second(0, 20), second(0, 21)}, second(0, 21), DayZone::kUtc);
  ASSERT_OK(nothing);
  EXPECT_THAT(*nothing, IsEmpty());
}

}  // namespace
}  // namespace engram::speech
