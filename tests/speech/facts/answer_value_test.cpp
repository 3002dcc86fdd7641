// SPDX-License-Identifier: Apache-2.0
#include "speech/facts/answer_value.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/ltm/expect_status.h"

namespace engram::speech {
namespace {

const ltm::MemoryId kStart = *ltm::MemoryId::parse("Skill/Event/robot/pick/2026-01-01 08:00:04");

TEST(AnswerValue, IsReadAsItWasWritten) {
  const Time time = *kStart.time();
  const std::vector<AnswerValue> values{
      answers::Unknown{},        answers::YesNo{true},
      answers::Count{3},         answers::Moment{time},
      answers::Seconds{3.25},    answers::Span{time, time + std::chrono::seconds(2)},
      answers::Metres{0.5},      names_of({"tea", "salt", "tea"}),
      answers::Events{{kStart}}, answers::Reason{"Ada said so", {kStart}}};
  for (const AnswerValue& value : values) {
    const auto again = answer_value_from_json(to_json(value));
    ASSERT_OK(again);
    EXPECT_EQ(*again, value) << to_json(value).dump();
  }
}

TEST(AnswerValue, IsWrittenAsTheDesignSays) {
  EXPECT_EQ(to_json(answers::Unknown{}).dump(), R"({"kind":"unknown"})");
  EXPECT_EQ(to_json(answers::Count{3}).dump(), R"({"kind":"count","value":3})");
  EXPECT_EQ(to_json(names_of({"tea", "salt", "tea"})).dump(),
            R"({"kind":"names","value":["salt","tea"]})");
  EXPECT_EQ(to_json(answers::Moment{*kStart.time()}).dump(),
            R"({"kind":"time","value":"2026-01-01 08:00:04.000000"})");
}

TEST(AnswerValue, NamesWhatDoesNotFit) {
  const auto read = [](const char* text) {
    return answer_value_from_json(nlohmann::ordered_json::parse(text));
  };
  EXPECT_FAILS(read("3"), StatusCode::kInvalidArgument, "needs an object");
  EXPECT_FAILS(read("{}"), StatusCode::kInvalidArgument, "member 'kind' is missing");
  EXPECT_FAILS(read(R"({"kind":"guess"})"), StatusCode::kInvalidArgument, "no kind 'guess'");
  EXPECT_FAILS(read(R"({"kind":"count","value":"3"})"), StatusCode::kInvalidArgument,
               "member 'value' is string, needs an integer");
  EXPECT_FAILS(read(R"({"kind":"names","value":[3]})"), StatusCode::kInvalidArgument,
               "needs a list of texts");
  EXPECT_FAILS(read(R"({"kind":"events","value":["a//b"]})"), StatusCode::kInvalidArgument,
               "name 2 of 3 is empty");
}

}  // namespace
}  // namespace engram::speech
