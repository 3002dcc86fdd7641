// SPDX-License-Identifier: Apache-2.0
// `engram reflect`: what it prints, what it records, and its exit codes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "ltm/recording/recorder.h"
#include "tests/cli/run_program.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::cli {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

constexpr int kFailed = 1;
constexpr int kWrongUsage = 2;
constexpr int kDoneWithLoss = 3;

/// A store with a sensor at 50 Hz; one of its values is no number, another has a hostile name.
class ReflectCommand : public ::testing::Test {
 protected:
  ReflectCommand() {
    write(store_, NAN);
    write(whole_, 0.5);
  }

  static void write(const std::string& store, double odd) {
    auto recorder = ltm::Recorder::open(store, {});
    ASSERT_TRUE(recorder.ok()) << recorder.status().to_string();
    const auto entity = ltm::MemoryId::parse("Robot/State/arm/\x1b[31mhot").value();
    for (int i = 0; i < 200; ++i) {
      const double value = i == 100 ? odd : std::sin(0.05 * i);
      ASSERT_TRUE(recorder
                      ->commit({{{entity,
                                  time_from_ns(int64_t{20'000'000} * (i + 1)),
                                  {{idf::Dict{{"x", value}}, {}}}}}})
                      .ok());
    }
    ASSERT_TRUE(recorder->close().ok());
  }

  ScratchDirectory directory_;
  std::string store_ = directory_ / "store";
  std::string whole_ = directory_ / "whole";
};

TEST_F(ReflectCommand, TellsWhatItFoundAndObeysNoName) {
  const RunResult text = run_engram({"reflect", store_});
  EXPECT_EQ(text.exit_code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("not-finite"));
  EXPECT_THAT(text.out, HasSubstr("found nan, needs a number"));
  EXPECT_THAT(text.out, HasSubstr("50 Hz"));
  EXPECT_THAT(text.out + text.err, Not(HasSubstr("\x1b")));
}

TEST_F(ReflectCommand, GivesJson) {
  const RunResult result = run_engram({"reflect", store_, "Robot/State", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, Not(HasSubstr("\x1b")));
  const Json json = Json::parse(result.out);
  EXPECT_EQ(json.at("snapshots"), 200);
  ASSERT_EQ(json.at("faults"), 1);
  const Json& finding = json.at("findings").at(0);
  EXPECT_EQ(finding.at("kind"), "not-finite");
  EXPECT_EQ(finding.at("member"), "x");
  EXPECT_EQ(finding.at("first_ns"), 2'020'000'000);
  EXPECT_EQ(json.at("entities").at(0).at("rate_hz"), 50);
}

TEST_F(ReflectCommand, FailsWhereItIsToldTo) {
  EXPECT_EQ(run_engram({"reflect", store_, "--fail-on", "fault"}).exit_code, kDoneWithLoss);
  EXPECT_EQ(run_engram({"reflect", store_, "--fail-on", "never"}).exit_code, kWrongUsage);
  EXPECT_EQ(run_engram({"reflect", store_, "a @ nonsense"}).exit_code, kWrongUsage);
  const RunResult missing = run_engram({"reflect", directory_ / "nowhere"});
  EXPECT_EQ(missing.exit_code, kFailed);
  EXPECT_THAT(missing.err, HasSubstr("nowhere"));
}

TEST_F(ReflectCommand, ComparesStores) {
  const RunResult text = run_engram({"reflect", store_, "--against", whole_});
  EXPECT_EQ(text.exit_code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("1 findings  0 findings"));
  const RunResult same = run_engram({"reflect", store_, "--against", store_, "--json"});
  EXPECT_EQ(Json::parse(same.out).at("differences").size(), 0u);
}

TEST_F(ReflectCommand, RecordsWhatItFound) {
  ASSERT_EQ(run_engram({"reflect", store_, "--commit"}).exit_code, 0);
  const RunResult asked = run_engram({"query", store_, "Reflection @ latest", "--json"});
  EXPECT_EQ(asked.exit_code, 0) << asked.err;
  EXPECT_THAT(asked.out, HasSubstr("not-finite"));
  const Json again = Json::parse(run_engram({"reflect", store_, "--json"}).out);
  EXPECT_EQ(again.at("entities").size(), 1u) << "reflections are not looked at";
}

}  // namespace
}  // namespace engram::cli
