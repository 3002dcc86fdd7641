// SPDX-License-Identifier: Apache-2.0
// What is true of the recording of seed 1, read by hand from what `engram query` prints of it.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "speech/dialogues/chosen_dialogues.h"
#include "tests/ltm/expect_status.h"
#include "tests/speech/dialogues/recorded_kitchens.h"

namespace engram::speech::dialogues {
namespace {

constexpr const char* kDay = "2026-01-01 ";

class KnownAnswersOfSeed1 : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    auto past = LivedPast::read(kitchen_of_seed_1());
    ASSERT_OK(past);
    past_ = *std::move(past);
    known_ = known_answers(past_, past_.last_moment(), 1);
  }

  /// The answers to a form of question, about a thing and a place, in no span of time.
  static std::vector<const KnownAnswer*> found(const std::string& form,
                                               const std::string& thing = {},
                                               const std::string& place = {},
                                               const std::string& skill = {}) {
    std::vector<const KnownAnswer*> all;
    for (const KnownAnswer& one : known_)
      if (form_of(one.asked) == form && one.asked.thing == thing && one.asked.place == place &&
          (skill.empty() || one.asked.skill == skill) &&
          (one.asked.when == "all" || one.asked.when == "now"))
        all.push_back(&one);
    return all;
  }

  static AnswerValue answer(const std::string& form, const std::string& thing = {},
                            const std::string& place = {}, const std::string& skill = {}) {
    const auto all = found(form, thing, place, skill);
    EXPECT_EQ(all.size(), 1U) << form << " " << thing << " " << place << " " << skill;
    return all.empty() ? AnswerValue(answers::Metres{-1}) : all.front()->value;
  }

  static ltm::MemoryId id(const std::string& entity, const std::string& clock) {
    return ltm::MemoryId::parse(entity + "/" + kDay + clock + "/0").value();
  }
  static ltm::MemoryId event(const std::string& skill, const std::string& clock) {
    return id("Skill/Event/robot/" + skill, clock);
  }
  static Time at(const std::string& clock) { return parse_time(kDay + clock).value(); }
  static AnswerValue names(std::vector<std::string> all) { return names_of(std::move(all)); }

  static inline LivedPast past_;
  static inline std::deque<KnownAnswer> known_;
};

TEST_F(KnownAnswersOfSeed1, CountWhatWasDone) {
  EXPECT_EQ(answer("how_often", "", "counter", "navigate"), AnswerValue(answers::Count{4}));
  EXPECT_EQ(answer("how_often", "", "table", "navigate"), AnswerValue(answers::Count{3}));
  EXPECT_EQ(answer("how_often:any", "salt", "", "pick"), AnswerValue(answers::Count{3}));
  EXPECT_EQ(answer("how_often:success", "salt", "", "pick"), AnswerValue(answers::Count{2}));
  // It was stopped, and then it succeeded.
  EXPECT_EQ(answer("how_often:any", "coffee", "", "pick"), AnswerValue(answers::Count{2}));
  EXPECT_EQ(answer("how_often", "salt", "", "place"), AnswerValue(answers::Count{2}));
  EXPECT_EQ(answer("how_many_commands"), AnswerValue(answers::Count{3}));
  // Whether an attempt that failed counts is not said, so it is not asked.
  EXPECT_TRUE(found("how_often", "salt", "", "pick").empty());
}

TEST_F(KnownAnswersOfSeed1, TellWhenItWas) {
  EXPECT_EQ(answer("when_did_you:first", "", "table", "navigate"),
            AnswerValue(answers::Moment{at("08:00:13.15")}));
  EXPECT_EQ(answer("when_did_you:last", "", "table", "navigate"),
            AnswerValue(answers::Moment{at("08:00:37.8")}));
  EXPECT_EQ(answer("when_did_you", "coffee", "", "place"),
            AnswerValue(answers::Moment{at("08:00:32.7")}));
  // The first attempt of the first pick failed, so only the last is asked for.
  EXPECT_EQ(answer("when_did_you:last", "salt", "", "pick"),
            AnswerValue(answers::Moment{at("08:00:40.75")}));
  EXPECT_TRUE(found("when_did_you:first", "salt", "", "pick").empty());
  EXPECT_NEAR(std::get<answers::Seconds>(answer("how_long_since_event", "salt", "", "pick")).value,
              15.29, 1e-6);
  EXPECT_EQ(answer("when_asked", "coffee"), AnswerValue(answers::Moment{at("08:00:20.4")}));
  EXPECT_EQ(answer("when_stopped"), AnswerValue(answers::Moment{at("08:00:23.5")}));
}

TEST_F(KnownAnswersOfSeed1, TellWhatCameFirstLastAndAfter) {
  EXPECT_EQ(answer("first_event"),
            AnswerValue(answers::Events{{event("look", "08:00:00.500000")}}));
  EXPECT_EQ(answer("last_event"),
            AnswerValue(answers::Events{{event("place", "08:00:48.550000")}}));
  EXPECT_EQ(answer("after_event", "coffee", "", "place"),
            AnswerValue(answers::Events{{event("look", "08:00:37.000000")}}));
  EXPECT_EQ(answer("before_event", "coffee", "counter", "place"),
            answer("before_event", "coffee", "", "place"));
  EXPECT_EQ(answer("before_event", "coffee", "", "place"),
            AnswerValue(answers::Events{{event("navigate", "08:00:29.350000")}}));
  EXPECT_EQ(answer("which_thing/pick:first"), names({"salt"}));
  EXPECT_EQ(answer("which_thing/place@:first", "", "counter"), names({"coffee"}));
  EXPECT_EQ(answer("which_thing/place@:last", "", "counter"), names({"salt"}));
  const auto with = answer("what_did_you_do_with", "coffee");
  EXPECT_EQ(std::get<answers::Events>(with).value.size(), 6U);
  const auto did = answer("what_did_you_do");
  EXPECT_EQ(std::get<answers::Events>(did).value.size(), 18U);
}

TEST_F(KnownAnswersOfSeed1, TellWhyByWhatLedToIt) {
  const auto why = found("why_event:last", "", "counter", "navigate");
  ASSERT_EQ(why.size(), 1U);
  EXPECT_EQ(why[0]->evidence, (std::vector{id("Speech/Commands/human/text", "08:00:37.000000"),
                                           id("Tasks/Plans/robot/plan", "08:00:37.000000")}));
  EXPECT_EQ(std::get<answers::Reason>(why[0]->value).value, "Put the salt on the counter, please.");
  const auto stopped = found("why_stopped");
  ASSERT_EQ(stopped.size(), 1U);
  EXPECT_EQ(stopped[0]->evidence,
            (std::vector{id("Speech/Commands/human/text", "08:00:23.100000")}));
  const auto failed = found("why_failed", "salt");
  ASSERT_EQ(failed.size(), 1U);
  EXPECT_EQ(failed[0]->evidence, (std::vector{event("pick", "08:00:06.750000")}));
  EXPECT_EQ(answer("who_stopped"), names({"Ada"}));
}

TEST_F(KnownAnswersOfSeed1, TellWhatWasAskedFor) {
  EXPECT_EQ(answer("who_asked"), names({"Ada"}));
  EXPECT_EQ(answer("plan_steps"), names({"look", "navigate", "pick", "place"}));
  EXPECT_EQ(answer("how_many_plan_steps"), AnswerValue(answers::Count{5}));
  const auto asked = found("what_was_asked:first");
  ASSERT_EQ(asked.size(), 1U);
  EXPECT_EQ(std::get<answers::Reason>(asked[0]->value).value, "I need the salt on the table.");
}

TEST_F(KnownAnswersOfSeed1, TellHowItWasDone) {
  EXPECT_EQ(answer("which_hand", "coffee", "", "pick"), names({"right"}));
  EXPECT_EQ(answer("from_where", "coffee", "", "pick"), names({"table"}));
  EXPECT_EQ(answer("to_where/navigate:last"), names({"counter"}));
  EXPECT_EQ(answer("which_hand", "coffee", "", "place"), names({"right"}));
  EXPECT_EQ(answer("to_where", "coffee", "", "place"), names({"counter"}));
  EXPECT_EQ(answer("which_hand", "coffee", "counter", "place"), names({"right"}));
  EXPECT_EQ(answer("how_long", "coffee", "counter", "place"),
            answer("how_long", "coffee", "", "place"));
  // It went to the table and back.
  EXPECT_TRUE(found("to_where", "salt", "", "place").empty());
  EXPECT_EQ(std::get<answers::Seconds>(answer("how_long", "coffee", "", "place")).value, 3.7);
  EXPECT_EQ(std::get<answers::Seconds>(answer("how_long:last", "", "counter", "navigate")).value,
            3.25);
  const double way = std::get<answers::Metres>(answer("how_far_driven", "", "", "navigate")).value;
  EXPECT_GT(way, 4.0);
  EXPECT_LT(way, 12.0);
}

TEST_F(KnownAnswersOfSeed1, TellWhatWentWrong) {
  const AnswerValue pick = answers::Events{{event("pick", "08:00:02.800000")}};
  EXPECT_EQ(answer("what_failed"), pick);
  // There was no other one.
  EXPECT_TRUE(found("first_failure").empty());
  EXPECT_TRUE(found("last_failure").empty());
  EXPECT_EQ(answer("when_first_failure"), AnswerValue(answers::Moment{at("08:00:06.75")}));
  EXPECT_EQ(answer("how_many_failures"), AnswerValue(answers::Count{1}));
  EXPECT_EQ(answer("things_failed/pick"), names({"salt"}));
  EXPECT_EQ(answer("how_many_failures/pick"), AnswerValue(answers::Count{1}));
  EXPECT_EQ(answer("how_many_failures/look"), AnswerValue(answers::Count{0}));
  EXPECT_EQ(answer("any_failure"), AnswerValue(answers::YesNo{true}));
  EXPECT_EQ(answer("retried", "salt", "", "pick"), AnswerValue(answers::YesNo{true}));
  EXPECT_EQ(answer("succeeded_eventually", "coffee", "", "pick"),
            AnswerValue(answers::YesNo{true}));
  EXPECT_EQ(answer("how_many_attempts", "coffee", "", "pick"), AnswerValue(answers::Count{2}));
  EXPECT_EQ(answer("how_many_stops"), AnswerValue(answers::Count{1}));
  EXPECT_EQ(answer("what_was_stopped"),
            AnswerValue(answers::Events{{event("pick", "08:00:22.200000")}}));
}

TEST_F(KnownAnswersOfSeed1, TellWhatWouldHaveBeenDone) {
  EXPECT_EQ(answer("what_if_not_stopped"), names({"navigate", "place"}));
  EXPECT_EQ(answer("what_next_if_not_stopped"), names({"navigate"}));
  EXPECT_EQ(answer("where_to_if_not_stopped_thing", "coffee"), names({"counter"}));
  EXPECT_EQ(answer("where_to_if_not_failed_thing", "salt"), names({"table"}));
  EXPECT_EQ(found("what_if_not_stopped").front()->evidence,
            (std::vector{id("Tasks/Plans/robot/plan", "08:00:20.400000")}));
}

TEST_F(KnownAnswersOfSeed1, TellWhereThingsAre) {
  EXPECT_EQ(answer("where_now", "coffee"), names({"counter"}));
  EXPECT_EQ(answer("where_now", "salt"), names({"counter"}));
  EXPECT_EQ(answer("was_moved", "coffee"), AnswerValue(answers::YesNo{true}));
  EXPECT_EQ(answer("is_thing_on_place", "salt", "table"), AnswerValue(answers::YesNo{false}));
  EXPECT_EQ(answer("is_held", "salt"), AnswerValue(answers::YesNo{false}));
  EXPECT_EQ(answer("who_holds", "salt"), names({}));
  EXPECT_EQ(answer("held_now"), names({}));
  const auto counter = std::get<answers::Names>(answer("things_on_place", "", "counter"));
  EXPECT_TRUE(std::find(counter.value.begin(), counter.value.end(), "salt") != counter.value.end());
}

TEST_F(KnownAnswersOfSeed1, TellWhatWasAtAMoment) {
  // From 8:00:29.35 to 8:00:32.7 it drove to the counter with the coffee in its hand, and it stood
  // at the table from 8:00:16.1 to 8:00:19.8.
  size_t checked = 0;
  for (const KnownAnswer& one : known_) {
    if (one.family != "at_a_time") continue;
    const auto told = one.slots.find("time");
    if (told == one.slots.end()) continue;
    const Time time = at("0" + told->second);
    const auto is_within = [&](const char* from, const char* to) {
      return time > at(from) && time < at(to);
    };
    if (one.asked.what == "doing_at" && is_within("08:00:29.35", "08:00:32.7")) {
      EXPECT_EQ(one.value, AnswerValue(answers::Events{{event("navigate", "08:00:29.350000")}}));
      ++checked;
    }
    if (one.asked.what == "held_at" && is_within("08:00:29.35", "08:00:32.7")) {
      EXPECT_EQ(one.value, names({"coffee"}));
      ++checked;
    }
    if (one.asked.what == "where_robot_at" && is_within("08:00:16.1", "08:00:19.8")) {
      EXPECT_EQ(one.value, names({"table"}));
      ++checked;
    }
    if (one.asked.what == "where_robot_at") {
      EXPECT_FALSE(is_within("08:00:29.35", "08:00:32.7")) << "it drove";
    }
  }
  EXPECT_GT(checked, 0U);
}

TEST_F(KnownAnswersOfSeed1, TellWhatGoesOn) {
  EXPECT_EQ(answer("doing_now"), AnswerValue(answers::Events{}));
  const Time now = at("08:00:31");
  const auto known = known_answers(past_.until(now), now, 1);
  ASSERT_GT(known.size(), 100U);
  const auto told = [&](const std::string& form, const std::string& thing = {}) {
    for (const KnownAnswer& one : known)
      if (form_of(one.asked) == form && one.asked.thing == thing &&
          (!one.slots.contains("when") || one.slots.at("when").empty()))
        return one.value;
    return AnswerValue();
  };
  EXPECT_EQ(told("doing_now"),
            AnswerValue(answers::Events{{event("navigate", "08:00:29.350000")}}));
  EXPECT_EQ(told("held_now"), names({"coffee"}));
  EXPECT_EQ(told("which_hand_holds", "coffee"), names({"right"}));
  EXPECT_EQ(told("who_holds", "coffee"), names({"right"}));
  EXPECT_EQ(told("where_now", "coffee"), names({"right"}));
  EXPECT_EQ(told("is_held", "coffee"), AnswerValue(answers::YesNo{true}));
  EXPECT_EQ(told("is_held", "salt"), AnswerValue(answers::YesNo{false}));
  EXPECT_EQ(told("how_many_commands"), AnswerValue(answers::Count{2}));
  // It drives, and nobody can say where it is.
  EXPECT_TRUE(is_unknown(told("where_robot_now")));
  for (const KnownAnswer& one : known)
    for (const ltm::MemoryId& id : one.evidence) EXPECT_LE(*id.time(), now) << form_of(one.asked);
}

TEST(KnownAnswers, KnowColoursThatAreRecorded) {
  const auto past = LivedPast::read(coloured_kitchen());
  ASSERT_OK(past);
  std::map<std::string, AnswerValue> colours;
  for (const KnownAnswer& one : known_answers(*past, past->last_moment(), 1))
    if (one.asked.what == "colour") colours.emplace(one.asked.thing, one.value);
  const auto named = [](const char* colour) { return AnswerValue(answers::Names{{colour}}); };
  const std::map<std::string, AnswerValue> kExpected{
      {"cereal", named("turquoise")}, {"coffee", named("blue")}, {"juice", named("turquoise")},
      {"milk", named("turquoise")},   {"oil", named("red")},     {"salt", named("red")},
      {"dish soap", named("yellow")}, {"tea", named("yellow")}};
  EXPECT_EQ(colours, kExpected);
}

TEST_F(KnownAnswersOfSeed1, KnowWhatDidNotHappen) {
  EXPECT_TRUE(found("colour", "salt").empty());

  size_t checked = 0;
  for (const KnownAnswer& one : known_) {
    if (one.asked.what != "unanswerable:never_done" || !one.asked.place.empty()) continue;
    ++checked;
    EXPECT_NE(one.asked.thing, "salt");
    EXPECT_NE(one.asked.thing, "coffee");
  }
  EXPECT_GT(checked, 0U);
  EXPECT_FALSE(found("unanswerable:never_done", "milk", "", "pick").empty());
  // The coffee went to the counter, and nowhere else.
  EXPECT_FALSE(found("unanswerable:never_done", "coffee", "table", "place").empty());
  EXPECT_TRUE(found("unanswerable:never_done", "coffee", "counter", "place").empty());
  EXPECT_TRUE(found("unanswerable:never_stopped").empty());
}

TEST_F(KnownAnswersOfSeed1, AllHaveWords) {
  ASSERT_GT(known_.size(), 100U);
  for (const KnownAnswer& one : known_) {
    const auto all = worded(one);
    EXPECT_TRUE(!all.empty() || (verb_phrases(one.asked).empty() && !one.asked.skill.empty()))
        << form_of(one.asked) << " " << one.asked.thing << " " << one.asked.place;
    for (const WordedQuestion& words : all)
      EXPECT_EQ(words.text.find_first_of("{}*@"), std::string::npos) << words.text;
  }
}

}  // namespace
}  // namespace engram::speech::dialogues
