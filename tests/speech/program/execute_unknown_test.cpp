// SPDX-License-Identifier: Apache-2.0
// What programs do not know, and what they know to be nothing.
#include <gtest/gtest.h>

#include "tests/speech/program/executing.h"

namespace engram::speech {
namespace {

using testing::Executing;
using testing::second;

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
