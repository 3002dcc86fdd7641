// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "speech/program/program.h"
#include "tests/ltm/expect_status.h"

namespace engram::speech {
namespace {

const std::vector<std::string>& valid_programs() {
  static const std::vector<std::string> kPrograms{
      "executions | events",
      "executions skill=pick thing=salt outcome=failure during=yesterday | last | why",
      "executions skill=pick,place thing=\"red cup\" place=table hand=left | count",
      "executions at=08:05:12 | events",
      "executions after=(executions skill=pick thing=tea | last | ended) | first | when",
      "executions skill=pick thing=salt | how_long | more_than=(executions skill=pick thing=tea | "
      "how_long)",
      "things place=table | which=thing",
      "things thing=salt | last_seen | where",
      "robot at=now-10s | where",
      "words speaker=Ada text=\"a \\\"quoted\\\" text\" | said",
      "plans thing=salt | count",
      "refusals skill=place | last | reason",
      "drives kind=blocked | exists",
      "executions | nth=3 | which=skill"};
  return kPrograms;
}

TEST(ProgramText, IsReadAsItIsPrinted) {
  for (const std::string& text : valid_programs()) {
    const auto program = Program::parse(text);
    ASSERT_OK(program);
    EXPECT_EQ(program->to_string(), text);
    const auto from_json = Program::from_json(program->to_json());
    ASSERT_OK(from_json);
    EXPECT_EQ(*from_json, *program) << program->to_json().dump();
  }
}

TEST(ProgramText, NamesWhatDoesNotFit) {
  const auto fails = [](const char* text, const char* part) {
    EXPECT_FAILS(Program::parse(text), StatusCode::kInvalidArgument, part);
  };
  fails("", "found 'the end' at 0, needs executions");
  fails("dreams | count", "found 'dreams'");
  fails("executions colour=red | count", "found 'colour' before 17, needs a filter");
  fails("executions skill | count", "needs '=' after skill");
  fails("executions skill=\"pick | count", "needs '\"' at the end");
  fails("executions skill=pick skill=place | count", "filter skill is there twice");
  fails("executions skill=pick", "ends without a value");
  fails("executions | guess", "found 'guess'");
  fails("executions | count | last", "last needs records before it");
  fails("executions outcome=good | count", "needs running, success, failure, stop, lost, problem");
  fails("executions during=soon | count", "'soon' is no time");
  fails("executions during=08:10..08:05 | count", "ends before it begins");
  fails("executions skill=(executions | when) | count", "has a program, needs a text");
  fails("executions after=(executions | count) | count", "needs one that ends in when or ended");
  fails("executions | nth=0 | when", "needs a number from 1");
  fails("executions | last=3 | when", "step last needs no value");
  fails("executions | which=colour", "needs one of thing, hand, skill, place, person");
  fails("executions | count | more_than=3", "needs a program in parentheses");
  fails("executions | count | more_than=(executions | when)", "same kind of value");
  fails("things skill=pick | count", "things have no filter skill");
  fails("robot | why", "robot have no step why");
  fails("executions | count)", "needs the end");
  fails("executions text=\"\xff\" | count", "valid UTF-8");
}

TEST(ProgramText, IsBounded) {
  std::string deep = "executions | when";
  for (int i = 0; i < 5; ++i) deep = "executions after=(" + deep + ") | when";
  EXPECT_FAILS(Program::parse(deep), StatusCode::kInvalidArgument, "programs in each other");
  EXPECT_FAILS(Program::parse(std::string(5000, ' ')), StatusCode::kInvalidArgument,
               "found 5000 bytes");
  std::string many = "executions";
  for (int i = 0; i < 40; ++i) many += " | last";
  EXPECT_FAILS(Program::parse(many + " | when"), StatusCode::kInvalidArgument, "fewer steps");
}

TEST(ProgramJson, NamesWhatDoesNotFit) {
  const auto read = [](const char* text) {
    return Program::from_json(nlohmann::ordered_json::parse(text));
  };
  EXPECT_FAILS(read("[]"), StatusCode::kInvalidArgument, "found array, needs an object");
  EXPECT_FAILS(read(R"({"source":3})"), StatusCode::kInvalidArgument, "'source' that is a text");
  EXPECT_FAILS(read(R"({"source":"executions","filters":{"colour":"red"}})"),
               StatusCode::kInvalidArgument, "no filter 'colour'");
  EXPECT_FAILS(read(R"({"source":"executions","steps":[3]})"), StatusCode::kInvalidArgument,
               "a step is number");
  EXPECT_FAILS(read(R"({"source":"executions","filters":{"thing":7}})"),
               StatusCode::kInvalidArgument, "found number, needs an object");
}

}  // namespace
}  // namespace engram::speech
