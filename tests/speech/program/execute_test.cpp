// SPDX-License-Identifier: Apache-2.0
#include "speech/program/execute.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/ltm/expect_status.h"
#include "tests/speech/remembered_kitchen.h"

namespace engram::speech {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::RememberedKitchen;
using testing::second;

class Executing : public ::testing::Test {
 protected:
  void SetUp() override {
    kitchen_.live_one_minute();
    auto facts = KnownFacts::read(kitchen_.memory());
    ASSERT_OK(facts);
    facts_ = *std::move(facts);
  }

  Outcome outcome_of(const std::string& text) {
    const auto program = Program::parse(text);
    EXPECT_OK(program);
    if (!program.ok()) return {};
    auto outcome = execute(*program, *facts_, now_, DayZone::kUtc);
    EXPECT_OK(outcome);
    return outcome.ok() ? *outcome : Outcome();
  }

  /// The value as JSON, without links; of what is unknown why it is.
  std::string value_of(const std::string& text) {
    const Outcome outcome = outcome_of(text);
    if (is_unknown(outcome.value)) {
      EXPECT_THAT(outcome.evidence, IsEmpty()) << text;
      return "unknown: " + outcome.missing;
    }
    EXPECT_THAT(outcome.evidence, Not(IsEmpty())) << text;
    for (const Evidence& evidence : outcome.evidence) EXPECT_OK(facts_->value_at(evidence.id));
    const auto json = to_json(outcome.value);
    return json.contains("value") ? json["value"].dump() : json.dump();
  }

  RememberedKitchen kitchen_;
  std::unique_ptr<KnownFacts> facts_;
  Time now_ = second(60);
};

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

TEST_F(Executing, KnowsNoEndThatCameLater) {
  const auto cites_nothing_later = [&](const std::string& text) {
    for (const Evidence& one : outcome_of(text).evidence)
      EXPECT_LE(one.id.time().value_or(now_), now_) << text << ": " << one.id.printable();
  };
  // The grasp of 08:00:04 failed at 08:00:08, and the next one began at 08:00:09.
  now_ = second(7.9);
  EXPECT_EQ(value_of("executions outcome=problem | exists"), "false");
  EXPECT_EQ(value_of("executions outcome=running | which=skill"), R"(["pick"])");
  EXPECT_EQ(value_of("executions skill=pick | last | reason"), "unknown: no reason is told of it");
  EXPECT_EQ(value_of("executions skill=pick | last | ended"), "unknown: it has not ended");
  EXPECT_EQ(value_of("executions skill=pick | last | succeeded"), "unknown: it has not ended");
  EXPECT_EQ(value_of("executions skill=pick | last | how_long"), "unknown: it has not ended");
  EXPECT_EQ(value_of("executions skill=pick | last | retried"), "false");
  EXPECT_EQ(value_of("executions | longest | which=skill"), R"(["pick"])");
  EXPECT_EQ(value_of("executions at=now | which=skill"), R"(["pick"])");
  EXPECT_EQ(value_of("executions | last | next | when"), "unknown: nothing was done after it");
  for (const char* text :
       {"executions outcome=problem | exists", "executions | events", "executions | count",
        "things thing=salt place=table | exists", "things held=yes | exists",
        "executions skill=place | none", "executions skill=navigate | how_far",
        "executions skill=pick | last | why", "things thing=salt | last_seen | where",
        "words | count", "plans | count", "robot | where"})
    cites_nothing_later(text);
  // An end at this very moment is known.
  now_ = second(8);
  EXPECT_EQ(value_of("executions outcome=problem | which=skill"), R"(["pick"])");
  EXPECT_EQ(value_of("executions outcome=problem | last | how_long"), "4.0");
  // Who stopped it spoke before it stopped.
  now_ = second(36.2);
  EXPECT_EQ(value_of("executions thing=tea skill=pick | last | who_stopped"),
            "unknown: nobody's words stopped it");
  EXPECT_EQ(value_of("words speaker=ben | last | said"), R"("Stop!")");
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

TEST_F(Executing, KnowsWhatDidNotHappenOnlyWhereSomethingDid) {
  EXPECT_EQ(value_of("executions skill=pick thing=\"red cup\" | exists"), "false");
  EXPECT_EQ(value_of("executions skill=pick thing=\"red cup\" | count"), "0");
  EXPECT_EQ(value_of("executions skill=pick thing=\"red cup\" | last | when"),
            "unknown: the memory has none");
  EXPECT_EQ(value_of("executions during=yesterday | exists"),
            "unknown: the memory has no record of that time");
}

TEST_F(Executing, KnowsThatThereWasNothing) {
  // The tea was let go at 08:00:36.5, and nothing was done since.
  EXPECT_EQ(value_of("executions at=now | events"), "[]");
  EXPECT_EQ(value_of("executions at=08:00:25 | events"), "[]");
  EXPECT_EQ(value_of("executions at=08:00:25 | exists"), "false");
  EXPECT_EQ(value_of("things held=yes | which=thing"), "[]");
  EXPECT_EQ(value_of("things held=yes hand=left at=08:00:14 | which=thing"), "[]");
  EXPECT_EQ(value_of("things place=table at=08:00:14 thing=tea | which=thing"), "[]");
  EXPECT_EQ(value_of("things visible=yes | which=thing"), "[]");
  EXPECT_EQ(value_of("executions outcome=problem during=08:00:09..08:00:30 | events"), "[]");
  EXPECT_EQ(value_of("executions skill=place place=counter | which=thing"), "[]");
  EXPECT_EQ(value_of("executions skill=place place=counter | how_many=thing"), "0");
  // What is asked of something that was done has no answer where nothing was.
  EXPECT_EQ(value_of("executions skill=place place=counter | last | events"),
            "unknown: the memory has none");
  EXPECT_EQ(value_of("executions skill=place place=counter | which=hand"),
            "unknown: the memory has none");
  EXPECT_EQ(value_of("executions skill=place place=counter | when"),
            "unknown: the memory has none");
}

TEST_F(Executing, KnowsNothingOfATimeWithoutRecords) {
  EXPECT_EQ(value_of("executions during=yesterday | events"),
            "unknown: the memory has no record of that time");
  EXPECT_EQ(value_of("executions at=yesterday/08:00:25 | events"),
            "unknown: the memory has no record of that time");
  EXPECT_EQ(value_of("executions at=2026-01-02/08:00 | exists"), "unknown: that time has not come");
  EXPECT_EQ(value_of("executions during=2026-01-02 | events"), "unknown: that time has not come");
  EXPECT_EQ(value_of("executions after=08:00:20 before=08:00:10 | exists"),
            "unknown: the memory has no record of that time");
  EXPECT_EQ(value_of("executions after=(executions | last | ended) | events"), "[]");
  EXPECT_EQ(value_of("things held=yes at=07:00 | which=thing"),
            "unknown: the memory has no record of that time");
  EXPECT_EQ(value_of("things during=yesterday | which=thing"),
            "unknown: the memory has no record of that time");
  EXPECT_EQ(value_of("things during=yesterday | exists"),
            "unknown: the memory has no record of that time");
  // Two hours later there are none of that time either, but things stay in the hands they are in.
  now_ = second(7200);
  EXPECT_EQ(value_of("executions at=now | events"),
            "unknown: the memory has no record of that time");
  EXPECT_EQ(value_of("things visible=yes | which=thing"),
            "unknown: the memory has no record of that time");
  EXPECT_EQ(value_of("things held=yes | which=thing"), "[]");
  // Of this day there are records without executions.
  kitchen_.see(0, "tea_box_1", -0.5, 1.5, 0.96, true, "", 2);
  ASSERT_OK(facts_->refresh());
  now_ = second(60, 2);
  EXPECT_EQ(value_of("executions during=today | events"), "[]");
  EXPECT_EQ(value_of("executions during=yesterday | events"),
            "unknown: the memory has no record of that time");
}

TEST_F(Executing, ShowsWhatWasThereInsteadOfWhatWasNot) {
  const auto shown = [&](const std::string& text) {
    std::string all;
    for (const Evidence& one : outcome_of(text).evidence) {
      const std::string id = one.id.to_string();
      all += id.substr(id.find('/', id.find('/') + 1) + 1) + "\n";
    }
    return all;
  };
  // Both grasps of the salt were with the right hand; and here the salt is now.
  EXPECT_EQ(shown("executions skill=pick thing=salt hand=left | exists"),
            "robot/pick/2026-01-01 08:00:04.000000/0\n"
            "robot/pick/2026-01-01 08:00:08.000000/0\n"
            "robot/pick/2026-01-01 08:00:09.000000/0\n"
            "robot/pick/2026-01-01 08:00:13.000000/0\n"
            "kitchen/salt_box_1/2026-01-01 08:01:00.000000/0\n");
  EXPECT_EQ(shown("executions skill=pick,place thing=\"red cup\" | none"),
            "robot/pick/2026-01-01 08:00:04.000000/0\n"
            "robot/pick/2026-01-01 08:00:08.000000/0\n"
            "robot/pick/2026-01-01 08:00:09.000000/0\n"
            "robot/pick/2026-01-01 08:00:13.000000/0\n"
            "robot/place/2026-01-01 08:00:16.000000/0\n"
            "robot/place/2026-01-01 08:00:19.000000/0\n"
            "robot/pick/2026-01-01 08:00:34.000000/0\n"
            "robot/pick/2026-01-01 08:00:36.500000/0\n"
            "kitchen/red_cup_1/2026-01-01 08:00:00.000000/0\n");
  EXPECT_EQ(shown("things thing=salt place=counter | exists"),
            "kitchen/salt_box_1/2026-01-01 08:01:00.000000/0\n");
  // What went on then, and what was done right before and after it.
  EXPECT_EQ(shown("executions skill=navigate at=08:00:10 | exists"),
            "robot/pick/2026-01-01 08:00:09.000000/0\n");
  EXPECT_EQ(shown("executions at=08:00:25 | events"),
            "robot/place/2026-01-01 08:00:19.000000/0\n"
            "robot/look/2026-01-01 08:00:30.000000/0\n");
  EXPECT_EQ(shown("words speaker=ada text=tea | exists"),
            "human/text/2026-01-01 08:00:01.000000/0\n"
            "human/text/2026-01-01 08:00:30.000000/0\n"
            "human/text/2026-01-01 08:00:36.000000/0\n");
  EXPECT_EQ(shown("executions outcome=lost | exists"),
            "robot/look/2026-01-01 08:00:01.000000/0\n"
            "robot/pick/2026-01-01 08:00:34.000000/0\n"
            "human/text/2026-01-01 08:00:36.000000/0\n"
            "robot/plan/2026-01-01 08:00:30.000000/0\n");
}

TEST_F(Executing, TakesNothingWithoutAnEndForGoingOnForEver) {
  // The recording of this day ended before the execution did.
  kitchen_.execute({.skill = "pick", .from = 50, .hand = "right", .day = 1, .is_ended = false});
  kitchen_.live_one_minute(2);
  kitchen_.execute({.skill = "look", .from = 61, .to = 3 * 86'400, .outcome = 4, .day = 2});
  ASSERT_OK(facts_->refresh());
  now_ = second(55, 1);
  EXPECT_EQ(value_of("executions at=now | which=skill"), R"(["pick"])");
  EXPECT_EQ(value_of("executions outcome=running | exists"), "true");
  now_ = second(60, 2);
  EXPECT_EQ(value_of("executions at=now | events"), "[]");
  EXPECT_EQ(value_of("executions outcome=running | exists"), "false");
  EXPECT_EQ(value_of("executions at=2026-01-02/12:00 | exists"),
            "unknown: the memory has no record of that time");
  // What was lost may have ended at any time before that was found out.
  now_ = second(60, 5);
  EXPECT_EQ(value_of("executions skill=look | longest | when"), R"("2026-01-01 08:00:01.000000")");
  EXPECT_EQ(value_of("executions skill=look | shortest | when"), R"("2026-01-01 08:00:01.000000")");
  EXPECT_EQ(value_of("executions skill=pick during=2026-01-04 | events"),
            "unknown: the memory has no record of that time");
}

TEST_F(Executing, KnowsWhatWasInSightInASpan) {
  // Both were in sight in the first half minute, and now neither is.
  EXPECT_EQ(value_of("things during=today visible=yes | which=thing"), R"(["salt","tea"])");
  EXPECT_EQ(value_of("things during=today thing=salt | is_visible"), "true");
  EXPECT_EQ(value_of("things during=today visible=no | which=thing"), R"(["red cup"])");
  EXPECT_EQ(value_of("things thing=salt | is_visible"), "false");
}

TEST_F(Executing, KnowsNoLengthWithoutAnEnd) {
  // The recording was cut off, and the same was begun again with the same hand a day later.
  kitchen_.execute({.skill = "wipe", .from = 50, .hand = "left", .is_ended = false});
  kitchen_.execute({.skill = "wipe", .from = 60, .to = 62, .hand = "left", .day = 1});
  kitchen_.execute({.skill = "navigate", .from = 70, .day = 1, .is_ended = false});
  ASSERT_OK(facts_->refresh());
  now_ = second(75, 1);
  const std::string unknown = "unknown: it is not known when it ended";
  EXPECT_EQ(value_of("executions skill=wipe | longest | when"), R"("2026-01-02 08:01:00.000000")");
  EXPECT_EQ(value_of("executions skill=wipe | shortest | when"), R"("2026-01-02 08:01:00.000000")");
  EXPECT_EQ(value_of("executions skill=wipe | first | how_long"), unknown);
  EXPECT_EQ(value_of("executions skill=wipe | first | ended"), unknown);
  EXPECT_EQ(value_of("executions skill=wipe | first | how_far"), unknown);
  EXPECT_EQ(value_of("executions skill=wipe | span"), unknown);
  // What goes on takes so long by now.
  EXPECT_EQ(value_of("executions during=today | longest | which=skill"), R"(["navigate"])");
  EXPECT_EQ(value_of("executions during=today | span"), "unknown: it has not ended");
}

TEST_F(Executing, KnowsNoSpanWhileThePartThatBeganFirstGoesOn) {
  kitchen_.execute({.skill = "wipe", .from = 50, .hand = "left", .is_ended = false});
  kitchen_.execute({.skill = "pour", .from = 52, .to = 53, .hand = "right"});
  ASSERT_OK(facts_->refresh());
  EXPECT_EQ(value_of("executions after=08:00:45 | span"), "unknown: it has not ended");
}

TEST_F(Executing, KnowsNoEndOfWhatWasLost) {
  kitchen_.execute({.skill = "wipe", .from = 40, .to = 55, .outcome = 4, .hand = "left"});
  kitchen_.execute({.skill = "wipe", .from = 45, .to = 47, .hand = "left"});
  ASSERT_OK(facts_->refresh());
  EXPECT_EQ(value_of("executions skill=wipe | first | how_long"),
            "unknown: it is not known when it ended");
  EXPECT_EQ(value_of("executions skill=wipe | first | ended"),
            "unknown: it is not known when it ended");
  // It began again before somebody found out that the first one was lost.
  EXPECT_EQ(value_of("executions skill=wipe | first | retried"), "true");
  EXPECT_EQ(value_of("executions outcome=lost | first | succeeded"), "false");
}

TEST_F(Executing, TakesNothingOfASilentMemoryForRunning) {
  kitchen_.execute({.skill = "wipe", .from = 50, .hand = "left", .is_ended = false});
  ASSERT_OK(facts_->refresh());
  EXPECT_EQ(value_of("executions outcome=running | which=skill"), R"(["wipe"])");
  now_ = second(4 * 3600);
  EXPECT_EQ(value_of("executions outcome=running | exists"),
            "unknown: the memory has no record of that time");
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

TEST_F(Executing, KnowsNothingOfWhatNothingIsCalled) {
  EXPECT_EQ(value_of("executions thing=elephant | count"), "unknown: no thing is called elephant");
  EXPECT_EQ(value_of("executions thing=oil | exists"), "unknown: none called oil was ever seen");
  EXPECT_EQ(value_of("executions skill=dance | exists"), "unknown: no skill is called dance");
  EXPECT_EQ(value_of("executions place=balcony | exists"), "unknown: no place is called balcony");
  EXPECT_EQ(value_of("words speaker=Olga | exists"), "unknown: no person who spoke is called Olga");
  EXPECT_EQ(value_of("executions after=(executions thing=elephant | last | when) | count"),
            "unknown: no thing is called elephant");
}

TEST_F(Executing, KnowsNothingOfAnyNameThatNothingHas) {
  EXPECT_EQ(value_of("executions thing=salt,elephant | exists"),
            "unknown: no thing is called elephant");
  EXPECT_EQ(value_of("executions thing=Objects/Instances/kitchen/ghost_1 | exists"),
            "unknown: no thing is called Objects/Instances/kitchen/ghost_1");
  EXPECT_EQ(value_of("executions hand=third | exists"), "unknown: no hand is called third");
  EXPECT_EQ(value_of("things hand=third | which=thing"), "unknown: no hand is called third");
  // Hands are the same by whatever name.
  kitchen_.see(58, "tea_box_1", 0, 0, 1, true, "Upper_Hand");
  EXPECT_EQ(value_of("things hand=upper at=08:00:59 | which=thing"), R"(["tea"])");
  EXPECT_EQ(value_of("things hand=\"upper hand\" at=08:00:59 | exists"), "true");
  EXPECT_EQ(value_of("things thing=tea at=08:00:59 | where"), R"(["upper hand"])");
  EXPECT_EQ(value_of("executions hand=\"right hand\" | count"), "3");
}

TEST_F(Executing, KnowsNothingOfPlacesWithoutAnExtent) {
  // The pantry has a name and nothing else, and where the oil is nobody tells.
  const auto commit = [&](const char* entity, idf::Dict value) {
    ASSERT_OK(kitchen_.memory().commit(
        {{{*ltm::MemoryId::parse(entity), second(1), {{idf::Data(std::move(value)), {}}}}}}));
  };
  commit("Navigation/Locations/kitchen/pantry", {{"name", "pantry"}, {"aliases", idf::List{}}});
  commit("Objects/Instances/kitchen/oil_bottle_1",
         {{"object_class", "Objects/Classes/kitchen/oil_bottle/2026-01-01 08:00:00/0"},
          {"pose_world_object", "nowhere"},
          {"is_visible", true},
          {"held_by", ""}});
  ASSERT_OK(facts_->refresh());
  EXPECT_EQ(value_of("things place=pantry | which=thing"),
            "unknown: it is not told how far that place reaches");
  EXPECT_EQ(value_of("things thing=salt place=pantry | exists"),
            "unknown: it is not told how far that place reaches");
  EXPECT_EQ(value_of("things thing=oil place=table | exists"),
            "unknown: it is not told where it was");
  EXPECT_EQ(value_of("things thing=oil | where"), "unknown: it was at no place that has a name");
  EXPECT_EQ(value_of("robot place=pantry | exists"), "unknown: it is not told where that place is");
  EXPECT_EQ(value_of("things place=counter | which=thing"), R"(["tea"])");
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

TEST(ExecutingOnNothing, IsUnknown) {
  const ScratchDirectory scratch;
  auto memory = Memory::open(scratch.path() / "empty.engram");
  ASSERT_OK(memory);
  const auto facts = KnownFacts::read(**memory);
  ASSERT_OK(facts);
  for (const char* text :
       {"executions | count", "executions at=now | events", "executions during=always | exists",
        "executions at=always | exists", "executions | last | previous | when",
        "words | last | said", "plans | which=thing", "refusals | exists", "drives | last | reason",
        "robot | where", "things held=yes | which=thing", "things | count",
        "things | last_seen | where", "things hand=left | exists", "executions | how_far"})
    for (const Time now : {Time{}, second(0), Time::min() + std::chrono::hours(48)}) {
      const auto program = Program::parse(text);
      ASSERT_OK(program);
      const auto outcome = execute(*program, **facts, now, DayZone::kUtc);
      ASSERT_OK(outcome);
      EXPECT_TRUE(is_unknown(outcome->value)) << text;
    }
}

TEST_F(Executing, SaysWhatItLookedFor) {
  EXPECT_EQ(
      outcome_of("executions skill=pick thing=elephant outcome=failure during=yesterday | count")
          .looked_for,
      "executions of pick of the elephant that failed (yesterday)");
}

}  // namespace
}  // namespace engram::speech
