// SPDX-License-Identifier: Apache-2.0
// `engram ask` and `engram tell`: what they print, and their exit codes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/cli/run_program.h"
#include "tests/ltm/expect_status.h"
#include "tests/speech/remembered_kitchen.h"

namespace engram::cli {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;
using ::testing::StartsWith;
using Json = nlohmann::json;

constexpr int kFailed = 1;
constexpr int kWrongUsage = 2;

class AskCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    kitchen_.live_one_minute();
    kitchen_.say(50, "Eve\x1b[31m", "Look \x1b[2J here.");
    ASSERT_OK(kitchen_.memory().close());
    store_ = kitchen_.store().string();
  }

  Json asked(const std::string& question) {
    const RunResult run = run_engram({"ask", store_, question, "--json"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return Json::parse(run.out, nullptr, false);
  }

  speech::testing::RememberedKitchen kitchen_;
  std::string store_;
};

TEST_F(AskCommand, AnswersWithTheSnapshotsThatItWasReadFrom) {
  const RunResult run = run_engram({"ask", store_, "Which hand did you use to grasp the salt?"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, StartsWith("My right hand.\n"));
  EXPECT_THAT(run.out, HasSubstr("started    Skill/Event/robot/pick/2026-01-01 08:00:09"));
  const Json json = asked("Which hand did you use to grasp the salt?");
  EXPECT_EQ(json["value"], Json::parse(R"({"kind":"names","value":["right"]})"));
  EXPECT_EQ(json["program"], "executions skill=pick thing=salt | last | which=hand");
  EXPECT_THAT(json["evidence"], SizeIs(2));
}

TEST_F(AskCommand, SaysThatItDoesNotKnowAndEndsWell) {
  const Json json = asked("Where is the elephant?");
  EXPECT_EQ(json["value"], Json::parse(R"({"kind":"unknown"})"));
  EXPECT_THAT(json["evidence"], IsEmpty());
  EXPECT_EQ(json["looked_for"], "executions of the elephant: no thing is called elephant");
  EXPECT_EQ(asked("Hello!")["route"], "none");
  EXPECT_EQ(asked(std::string(100'000, 'x'))["route"], "none");
}

TEST_F(AskCommand, CountsTimesFromNow) {
  const auto value = [&](const std::string& now) {
    const RunResult run =
        run_engram({"ask", store_, "What did you do yesterday?", "--now", now, "--json"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return Json::parse(run.out, nullptr, false)["value"];
  };
  EXPECT_EQ(value("2026-01-01 12:00:00")["kind"], "unknown");
  EXPECT_THAT(value("2026-01-02 12:00:00")["value"], SizeIs(9));
}

TEST_F(AskCommand, TakesPrograms) {
  const RunResult run =
      run_engram({"ask", store_, "--program", "executions outcome=failure | count", "--json"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(Json::parse(run.out)["value"]["value"], 1);
  const RunResult wrong = run_engram({"ask", store_, "--program", "executions | guess"});
  EXPECT_EQ(wrong.exit_code, kWrongUsage);
  EXPECT_THAT(wrong.err, HasSubstr("found 'guess'"));
}

TEST_F(AskCommand, AnswersEachLineOfAFile) {
  const std::string file = store_ + ".jsonl";
  std::ofstream(file) << R"({"question": "Where is the salt?"})"
                      << "\n\n"
                      << R"({"question": "What did you do?", "now": "2026-01-01 08:00:03"})"
                      << "\n"
                      << R"({"question": "\u0000\u001b[31m"})"
                      << "\n";
  const RunResult run = run_engram({"ask", store_, "--questions", file});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  std::istringstream lines(run.out);
  std::vector<Json> answers;
  for (std::string line; std::getline(lines, line);) answers.push_back(Json::parse(line));
  ASSERT_THAT(answers, SizeIs(3));
  EXPECT_EQ(answers[0]["value"]["value"], Json::parse(R"(["table"])"));
  EXPECT_THAT(answers[1]["value"]["value"], SizeIs(2));
  EXPECT_EQ(answers[2]["route"], "none");
}

TEST_F(AskCommand, NamesTheLineThatIsNoQuestion) {
  const std::string file = store_ + ".jsonl";
  std::ofstream(file) << R"({"question": "Where is the salt?"})"
                      << "\n[1]\n";
  const RunResult run = run_engram({"ask", store_, "--questions", file});
  EXPECT_EQ(run.exit_code, kFailed);
  EXPECT_THAT(run.err, HasSubstr("line 2 needs a JSON object"));
  EXPECT_EQ(run_engram({"ask", store_, "--questions", store_ + ".none"}).exit_code, kFailed);
}

TEST_F(AskCommand, RefusesWrongUsage) {
  EXPECT_EQ(run_engram({"ask", store_, "Where?", "--questions", "file"}).exit_code, kWrongUsage);
  EXPECT_EQ(run_engram({"ask", store_, "Where?", "--now", "soon"}).exit_code, kWrongUsage);
  const RunResult missing = run_engram({"ask", store_ + ".none", "Where is the salt?"});
  EXPECT_EQ(missing.exit_code, kFailed);
  EXPECT_THAT(missing.err, HasSubstr(".none"));
}

TEST_F(AskCommand, ObeysNoName) {
  const RunResult run = run_engram({"ask", store_, "What was said last?"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("Look"));
  EXPECT_THAT(run.out + run.err, Not(HasSubstr("\x1b")));
}

TEST_F(AskCommand, TellsATimeInSentencesWithLinks) {
  const RunResult text = run_engram({"tell", store_});
  EXPECT_EQ(text.exit_code, 0) << text.err;
  EXPECT_THAT(text.out,
              StartsWith("From 08:00:01 to 08:00:36 I carried out 9 actions for 2 tasks"));
  EXPECT_THAT(text.out, HasSubstr("Skill/Event/robot/pick/2026-01-01 08:00:04"));
  const RunResult run = run_engram({"tell", store_, "--sentences", "3", "--json"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const Json json = Json::parse(run.out);
  ASSERT_THAT(json["sentences"], SizeIs(3));
  for (const Json& sentence : json["sentences"]) EXPECT_THAT(sentence["links"], Not(IsEmpty()));
  const RunResult nothing =
      run_engram({"tell", store_, "--since", "yesterday", "--until", "08:00"});
  EXPECT_EQ(nothing.exit_code, 0) << nothing.err;
  EXPECT_EQ(run_engram({"tell", store_, "--since", "soon"}).exit_code, kWrongUsage);
  EXPECT_EQ(run_engram({"tell", store_, "--since", "now", "--until", "yesterday"}).exit_code,
            kFailed);
}

}  // namespace
}  // namespace engram::cli
