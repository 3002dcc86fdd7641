// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/told_events.h"

#include "tests/ltm/expect_status.h"

namespace engram::ltm {
namespace {

using idf::Dict;

TEST(ToldEvents, OutcomesAreReadByNamesTextsAndEnums) {
  const auto outcome = [](idf::Data value) { return told_events(std::move(value), {}).outcome; };
  EXPECT_EQ(outcome(Dict{{"outcome", "Succeeded"}}), ActionOutcome::kSuccess);
  EXPECT_EQ(outcome(Dict{{"status", "unsuccessful"}}), ActionOutcome::kFailure);
  EXPECT_EQ(outcome(Dict{{"result", "preempted"}}), ActionOutcome::kStop);
  EXPECT_EQ(outcome(Dict{{"status", "RUNNING"}}), ActionOutcome::kRunning);
  EXPECT_EQ(outcome(Dict{{"success", false}}), ActionOutcome::kFailure);
  EXPECT_EQ(outcome(Dict{{"state", "failed"}}), ActionOutcome::kUnknown);
  EXPECT_EQ(outcome("failed"), ActionOutcome::kUnknown);
  // The first member that tells one counts.
  EXPECT_EQ(outcome(Dict{{"status", "ok"}, {"success", true}}), ActionOutcome::kSuccess);
  const idf::Type type = idf::Type::object(
      "Action", {{"outcome", idf::Type::int_enum("Outcome", {{"RUNNING", 0}, {"STOP", 3}})}});
  EXPECT_EQ(told_events(Dict{{"outcome", 3}}, type).outcome, ActionOutcome::kStop);
  EXPECT_EQ(told_events(Dict{{"outcome", 1}}, type).outcome, ActionOutcome::kUnknown);
  EXPECT_EQ(name_of(ActionOutcome::kStop), "stop");
}

TEST(ToldEvents, LinksAreNoSpeech) {
  const auto told = told_events(Dict{{"text", "Objects/Instances/kitchen/tea"}}, {});
  EXPECT_FALSE(told.is_speech);
  EXPECT_NE(told.links, 0u);
  EXPECT_TRUE(told_events(Dict{{"said", Dict{{"words", "Bring the tea."}}}}, {}).is_speech);
  EXPECT_FALSE(told_events(Dict{{"words", ""}}, {}).is_speech);
}

TEST(ToldEvents, HostileDepthEnds) {
  idf::Data deep = "Stop!";
  for (int i = 0; i < 1000; ++i) deep = idf::List{deep};
  EXPECT_FALSE(told_events(deep, {}).is_speech);
}

}  // namespace
}  // namespace engram::ltm
