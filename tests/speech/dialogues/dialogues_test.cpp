// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "speech/dialogues/make_dialogues.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/speech/dialogues/recorded_kitchens.h"

namespace engram::speech {
namespace {

std::vector<Dialogue> made(Memory& memory, const DialogueOptions& options) {
  auto dialogues = make_dialogues(memory, options);
  EXPECT_OK(dialogues);
  return dialogues.ok() ? *std::move(dialogues) : std::vector<Dialogue>();
}

std::vector<std::string> lines_of(const std::vector<Dialogue>& dialogues) {
  std::vector<std::string> lines;
  for (const Dialogue& dialogue : dialogues) lines.push_back(to_json_line(dialogue));
  return lines;
}

/// All IDs that dialogues name exist in the memory.
void expect_evidence(Memory& memory, const std::vector<Dialogue>& dialogues) {
  std::set<ltm::MemoryId> there;
  const auto answer = memory.query(
      "?ids Skill @ all ; Speech @ all ; Tasks @ all ; Objects @ all ; RobotState @ all");
  ASSERT_OK(answer);
  for (const ltm::MemoryId& id : answer->ids()) there.insert(id);
  size_t checked = 0;
  for (const Dialogue& dialogue : dialogues) {
    std::vector<ltm::MemoryId> ids = dialogue.evidence;
    if (const auto* events = std::get_if<answers::Events>(&dialogue.value))
      ids.insert(ids.end(), events->value.begin(), events->value.end());
    if (const auto* reason = std::get_if<answers::Reason>(&dialogue.value))
      ids.insert(ids.end(), reason->links.begin(), reason->links.end());
    for (const ltm::MemoryId& id : ids) {
      EXPECT_TRUE(there.contains(id)) << dialogue.question << " -> " << id.to_string();
      ++checked;
    }
  }
  EXPECT_GT(checked, dialogues.size() / 2);
}

/// "I do not know", "no", "none", "0".
bool tells_of_nothing(const AnswerValue& value) {
  return is_unknown(value) || value == AnswerValue(answers::YesNo{false}) ||
         value == AnswerValue(answers::Count{0}) || value == AnswerValue(answers::Names{}) ||
         value == AnswerValue(answers::Events{});
}

TEST(Dialogues, HaveEvidenceThatTheMemoryHas) {
  expect_evidence(kitchen_of_seed_1(), made(kitchen_of_seed_1(), {.count = 600}));
  expect_evidence(three_days(), made(three_days(), {.count = 300}));
}

TEST(Dialogues, AreEqualForEqualOptions) {
  const DialogueOptions options{.count = 120, .seed = 7, .careless = 0.3};
  const auto first = lines_of(made(kitchen_of_seed_1(), options));
  EXPECT_EQ(first, lines_of(made(kitchen_of_seed_1(), options)));
  EXPECT_NE(first, lines_of(made(kitchen_of_seed_1(), {.count = 120, .seed = 8})));
}

TEST(Dialogues, TakeTheFamiliesInTurn) {
  std::map<std::string, int> families;
  std::set<std::string> questions;
  const auto dialogues = made(kitchen_of_seed_1(), {.count = 160});
  for (const Dialogue& dialogue : dialogues) {
    ++families[dialogue.family];
    questions.insert(dialogue.question + to_string(dialogue.now));
    EXPECT_EQ(dialogue.family == "unanswerable", is_unknown(dialogue.value)) << dialogue.question;
    // Only that nothing happened is shown by nothing.
    EXPECT_TRUE(!dialogue.evidence.empty() || tells_of_nothing(dialogue.value))
        << dialogue.question;
    for (const AnswerValue& other : dialogue.also)
      EXPECT_FALSE(is_unknown(other)) << dialogue.question;
  }
  EXPECT_EQ(dialogues.size(), 160U);
  EXPECT_EQ(questions.size(), dialogues.size());
  EXPECT_EQ(families.size(), 8U);
  for (const auto& [family, count] : families) EXPECT_NEAR(count, 20, 8) << family;
}

TEST(Dialogues, AreAlsoAskedWhileTheRobotWorks) {
  std::map<Time, int> by_now;
  std::map<std::string, std::set<std::string>> values;
  for (const Dialogue& dialogue : made(kitchen_of_seed_1(), {.count = 2400})) {
    ++by_now[dialogue.now];
    values[dialogue.form].insert(to_json(dialogue.value).dump());
  }
  // At the end, on the next day, and twice before.
  ASSERT_EQ(by_now.size(), 4U);
  int within = 0;
  for (const auto& [now, count] : by_now)
    if (now < *parse_time("2026-01-01 08:00:59")) within += count;
  EXPECT_GT(within, 400);
  EXPECT_LT(within, 1600);
  for (const char* form : {"held_now", "is_held", "who_holds", "doing_now", "things_visible"})
    EXPECT_GE(values[form].size(), 2U) << form;
  EXPECT_GE(values["which_hand_holds"].size(), 1U);
}

TEST(Dialogues, KnowNoMoreThanAtTheirTime) {
  const Time now = *parse_time("2026-01-01 08:00:31");
  const auto dialogues = made(kitchen_of_seed_1(), {.count = 300, .now = now});
  EXPECT_EQ(dialogues.size(), 300U);
  for (const Dialogue& dialogue : dialogues) {
    EXPECT_EQ(dialogue.now, now);
    for (const ltm::MemoryId& id : dialogue.evidence)
      EXPECT_LE(*id.time(), now) << dialogue.question;
  }
  EXPECT_FAILS(make_dialogues(kitchen_of_seed_1(), {.now = Time()}), StatusCode::kInvalidArgument,
               "when a recording begins");
}

TEST(Dialogues, ForTrainingHaveNothingThatIsHeldOut) {
  // Seed 1 is not held out, or there would be nothing to train on.
  ASSERT_FALSE(is_seed_held_out(1));
  const auto trained = made(kitchen_of_seed_1(), {.count = 200, .split = DialogueSplit::kTrain});
  EXPECT_GT(trained.size(), 100U);
  for (const Dialogue& dialogue : trained)
    EXPECT_TRUE(dialogue.held_out.empty()) << dialogue.question;
  const auto kept = made(kitchen_of_seed_1(), {.count = 200, .split = DialogueSplit::kHeldOut});
  EXPECT_GT(kept.size(), 100U);
  for (const Dialogue& dialogue : kept) EXPECT_FALSE(dialogue.held_out.empty());
}

TEST(Dialogues, HoldOutAboutAFifth) {
  int seeds = 0;
  for (int64_t seed = 0; seed < 1000; ++seed) seeds += is_seed_held_out(seed) ? 1 : 0;
  EXPECT_NEAR(seeds, 200, 40);
  std::set<std::string> things;
  for (const char* thing : {"cereal", "milk", "tea", "salt", "juice", "oil", "dish soap",
                            "tomatoes", "coffee", "blue mug"})
    if (is_thing_held_out(thing)) things.insert(thing);
  EXPECT_GE(things.size(), 1U);
  EXPECT_LE(things.size(), 4U);
}

TEST(Dialogues, KnowOneDayFromAnother) {
  std::set<std::string> yesterdays;
  for (const Dialogue& dialogue : made(three_days(), {.count = 400})) {
    if (dialogue.question.find("yesterday") == std::string::npos) continue;
    // Asked on January 3 it is January 2, asked on January 4 it is January 3.
    const std::string now = to_string(dialogue.now).substr(0, 10);
    const std::string yesterday = now == "2026-01-03" ? "2026-01-02" : "2026-01-03";
    EXPECT_TRUE(now == "2026-01-03" || now == "2026-01-04") << now;
    for (const ltm::MemoryId& id : dialogue.evidence)
      EXPECT_EQ(to_string(*id.time()).substr(0, 10), yesterday) << dialogue.question;
    yesterdays.insert(dialogue.form);
  }
  EXPECT_GE(yesterdays.size(), 5U);
}

TEST(Dialogues, PutQuestionsCarelessly) {
  int small = 0;
  int swapped = 0;
  for (const Dialogue& dialogue : made(kitchen_of_seed_1(), {.count = 200, .careless = 1})) {
    small += dialogue.phrasing.ends_with("+small") ? 1 : 0;
    swapped += dialogue.phrasing.ends_with("+swapped") ? 1 : 0;
    if (dialogue.phrasing.ends_with("+small")) {
      EXPECT_EQ(dialogue.question.find_first_of("?!ABCDEFGHIJKLMNOPQRSTUVWXYZ"), std::string::npos);
    }
  }
  EXPECT_GT(small, 60);
  EXPECT_GT(swapped, 30);
}

TEST(Dialogues, TakeTheWordsOfOthers) {
  const ScratchDirectory scratch;
  const auto file = scratch.path() / "words.jsonl";
  std::ofstream(file)
      << R"({"question": "Hey, where has the {thing} got to?", "asks": {"what": "where_now", "thing": "{thing}", "when": "now"}, "family": "objects"}
{"question": "So who yelled stop at you?", "asks": {"what": "who_stopped", "when": "all"}, "family": "explanations"}
{"question": "Where did the elephant go?", "asks": {"what": "unanswerable", "why_unanswerable": "unknown_thing"}, "family": "unanswerable"}
{"question": "Is the moon full?", "asks": {"what": "nothing_that_is_known", "when": "all"}, "family": "events"}
)";
  const auto dialogues = make_dialogues_with(kitchen_of_seed_1(), {}, file);
  ASSERT_OK(dialogues);
  std::map<std::string, Dialogue> by_phrasing;
  for (const Dialogue& one : *dialogues) by_phrasing[one.phrasing] = one;
  ASSERT_EQ(by_phrasing.size(), 3U);
  EXPECT_TRUE(by_phrasing["foreign#0"].question.starts_with("Hey, where has the "));
  EXPECT_EQ(by_phrasing["foreign#1"].value, AnswerValue(names_of({"Ada"})));
  EXPECT_TRUE(is_unknown(by_phrasing["foreign#2"].value));

  std::ofstream(file) << "{\"question\": 3}\n";
  EXPECT_FAILS(make_dialogues_with(kitchen_of_seed_1(), {}, file), StatusCode::kInvalidArgument,
               "line 1 needs a text 'question'");
  EXPECT_FAILS(make_dialogues_with(kitchen_of_seed_1(), {}, scratch.path() / "none"),
               StatusCode::kUnavailable, "cannot be read");
}

TEST(Dialogues, FillTheTemplatesOfOthers) {
  const ScratchDirectory scratch;
  const auto file = scratch.path() / "written.jsonl";
  std::ofstream(file)
      << R"({"form": "when_did_you:last", "question": "Time of the last moment you {did}, please?"}

{"form": "which_hand", "skill": "place", "question": "{thing} set down: by left or right?"}
{"form": "was_hand", "question": "Was your {hand} gripper used to {do}?"}
{"form": "how_many_failures", "question": "Number of failures{when}, robot?"}
{"form": "unanswerable:unknown_thing", "question": "Did I leave the {thing} beside the {known}?"}
{"form": "where_now", "skill": "navigate", "question": "Where is it?"}
{"form": "doing_at", "question": "{at}: state your activity"}
)";
  const auto dialogues = make_dialogues_with(kitchen_of_seed_1(), {.seed = 3}, file);
  ASSERT_OK(dialogues);
  std::map<std::string, Dialogue> by_form;
  for (const Dialogue& one : *dialogues) {
    EXPECT_EQ(one.question.find('{'), std::string::npos) << one.question;
    by_form[one.form] = one;
  }
  // The words of one of them lack the thing.
  EXPECT_EQ(by_form.size(), 6U);
  EXPECT_FALSE(by_form.contains("where_now"));
  EXPECT_EQ(kind_of(by_form["when_did_you:last"].value), "time");
  EXPECT_NE(by_form["when_did_you:last"].phrasing.find("#w"), std::string::npos);
  EXPECT_TRUE(by_form["which_hand"].question.ends_with(" set down: by left or right?"));
  EXPECT_EQ(kind_of(by_form["was_hand"].value), "yes_no");
  EXPECT_EQ(by_form["unanswerable:unknown_thing"].family, "unanswerable");
  EXPECT_EQ(by_form["doing_at"].family, "at_a_time");

  const auto fewer = make_dialogues_with(kitchen_of_seed_1(), {.count = 2, .seed = 3}, file);
  ASSERT_OK(fewer);
  EXPECT_EQ(fewer->size(), 2U);
  std::ofstream(file) << R"({"form": "when_did_i", "question": "When?"})"
                      << "\n";
  EXPECT_FAILS(make_dialogues_with(kitchen_of_seed_1(), {}, file), StatusCode::kInvalidArgument,
               "line 1 needs a known 'form'");
}

TEST(Dialogues, KeepTemplatesOfOthersForTrials) {
  const ScratchDirectory scratch;
  const auto file = scratch.path() / "written.jsonl";
  std::ofstream lines(file);
  constexpr size_t kLines = 200;
  for (size_t i = 0; i < kLines; ++i)
    lines << R"({"form": "things_seen", "question": "Things seen, request )" << i << "?\"}\n";
  lines.close();
  const auto trained =
      make_dialogues_with(kitchen_of_seed_1(), {.split = DialogueSplit::kTrain}, file);
  const auto kept =
      make_dialogues_with(kitchen_of_seed_1(), {.split = DialogueSplit::kHeldOut}, file);
  ASSERT_OK(trained);
  ASSERT_OK(kept);
  EXPECT_EQ(trained->size() + kept->size(), kLines);
  EXPECT_NEAR(static_cast<double>(kept->size()), kLines / 5.0, 20);
}

TEST(Dialogues, TakeTheWordingsThatComeWithEngram) {
  const auto dialogues = make_written_dialogues(kitchen_of_seed_1(), {.count = 300, .seed = 2});
  ASSERT_OK(dialogues);
  EXPECT_EQ(dialogues->size(), 300U);
  std::set<std::string> forms;
  for (const Dialogue& one : *dialogues) {
    forms.insert(one.form);
    EXPECT_NE(one.phrasing.find(one.form + "#w"), std::string::npos) << one.phrasing;
    EXPECT_EQ(one.question.find_first_of("{}"), std::string::npos) << one.question;
    EXPECT_EQ(one.family == "unanswerable", is_unknown(one.value)) << one.question;
    EXPECT_TRUE(one.plain.empty()) << one.question;
  }
  EXPECT_GT(forms.size(), 50U);
  expect_evidence(kitchen_of_seed_1(), *dialogues);
}

TEST(Dialogues, TellPlainlyWhereThatIsWanted) {
  const auto dialogues =
      make_written_dialogues(kitchen_of_seed_1(), {.count = 100, .seed = 2, .tells_plainly = true});
  ASSERT_OK(dialogues);
  ASSERT_EQ(dialogues->size(), 100U);
  size_t told = 0;
  for (const Dialogue& one : *dialogues) {
    EXPECT_LE(one.plain.size(), 3U) << one.question;
    told += one.plain.empty() ? 0 : 1;
    for (const std::string& words : one.plain) {
      EXPECT_EQ(words.find_first_of("{}"), std::string::npos) << words;
      EXPECT_NE(words, one.question);
    }
  }
  EXPECT_GT(told, 90U);
  // The own words are among what is asked in them, too.
  for (const Dialogue& one : made(kitchen_of_seed_1(), {.count = 20, .tells_plainly = true}))
    EXPECT_FALSE(one.plain.empty()) << one.question;
}

TEST(Dialogues, NeedARecordingOfAKitchen) {
  const ScratchDirectory scratch;
  auto memory = Memory::open(scratch.path() / "empty.engram");
  ASSERT_OK(memory);
  EXPECT_FAILS(make_dialogues(**memory, {}), StatusCode::kNotFound, "no recording of a kitchen");
  EXPECT_FAILS(make_dialogues(kitchen_of_seed_1(), {.careless = 2}), StatusCode::kInvalidArgument,
               "careless is 2");
}

}  // namespace
}  // namespace engram::speech
