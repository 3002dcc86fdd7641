// SPDX-License-Identifier: Apache-2.0
// `engram learn-answers`, `engram consolidate --answers`, and who finds what they learned.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/cli/run_program.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::cli {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

constexpr int kFailed = 1;
constexpr int kWrongUsage = 2;

/// A store with a short simulated kitchen.
class LearnAnswers : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(run_engram({"simulate", "kitchen", store(), "--no-images", "--seconds", "40",
                          "--progress", "none"})
                  .exit_code,
              0);
  }

  [[nodiscard]] std::string store() const { return (folder_.path() / "kitchen.engram").string(); }
  [[nodiscard]] std::filesystem::path own() const {
    return folder_.path() / "kitchen.engram" / "answers" / "questions.attention";
  }
  RunResult learn(std::vector<std::string> more = {}) {
    std::vector<std::string> words{"learn-answers", store(),    "--own-words", "--dialogues",
                                   "260",           "--budget", "2s"};
    words.insert(words.end(), more.begin(), more.end());
    return run_engram(words);
  }
  Json asked(std::vector<std::string> more) {
    std::vector<std::string> words{"ask", store(), "Where is the salt?", "--json"};
    words.insert(words.end(), more.begin(), more.end());
    const RunResult run = run_engram(words);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return Json::parse(run.out, nullptr, false);
  }

  ScratchDirectory folder_;
};

TEST_F(LearnAnswers, IsFoundByWhoeverAsksTheStore) {
  EXPECT_EQ(run_engram({"ask", store(), "Where is the salt?", "--route", "attention"}).exit_code,
            kFailed);
  const RunResult run = learn({"--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Json report = Json::parse(run.out, nullptr, false);
  EXPECT_EQ(report["file"], own().string());
  EXPECT_GT(report["steps"], 0);
  EXPECT_GT(report["with_program"], 100);
  ASSERT_TRUE(std::filesystem::exists(own()));
  // What two seconds taught is not sure of anything, or rightly is.
  EXPECT_THAT(asked({"--route", "attention"})["route"].get<std::string>(),
              AnyOf("none", "attention"));
  EXPECT_EQ(asked({"--route", "program"})["route"], "program");
  EXPECT_EQ(run_engram({"check", store()}).exit_code, 0);
  const RunResult more =
      learn({"--from", own().string(), "--out", (folder_.path() / "b.attention").string()});
  EXPECT_EQ(more.exit_code, 0) << more.err;
  EXPECT_THAT(more.out, HasSubstr("held-out questions"));
}

TEST_F(LearnAnswers, IsPassedOverWhereItIsDamaged) {
  std::filesystem::create_directories(own().parent_path());
  std::ofstream(own()) << "no network";
  const RunResult run = run_engram({"ask", store(), "Where is the salt?"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.out, HasSubstr("the salt was"));
  EXPECT_THAT(run.err, HasSubstr("questions.attention"));
  // A file that somebody names has to be one.
  EXPECT_EQ(
      run_engram({"ask", store(), "Where is the salt?", "--attention", own().string()}).exit_code,
      kFailed);
  EXPECT_EQ(learn({"--from", own().string()}).exit_code, kFailed);
}

TEST_F(LearnAnswers, NeedsTimeAndAPlace) {
  EXPECT_EQ(learn({"--budget", "soon"}).exit_code, kWrongUsage);
  EXPECT_EQ(run_engram({"learn-answers", store(), store()}).exit_code, kWrongUsage);
  EXPECT_EQ(run_engram({"learn-answers", (folder_.path() / "none.engram").string()}).exit_code,
            kFailed);
}

TEST_F(LearnAnswers, EndsWithTheNight) {
  // Of a night that is over, nothing is learned and nothing fails.
  const RunResult run = run_engram({"consolidate", store(), "--entity", "Speech/.*", "--answers",
                                    "10m", "--budget", "1s", "--progress", "none"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("no time is left"));
  EXPECT_FALSE(std::filesystem::exists(own()));
}

}  // namespace
}  // namespace engram::cli
