// SPDX-License-Identifier: Apache-2.0
// `engram crossval`: what it prints of each recording that is left out.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/cli/run_program.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::cli {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

class CrossvalCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto recording = make_recording(directory_.path(), 8);
    for (const char* start : {"2022-02-18 13:00:00", "2022-02-18 14:00:00"})
      ASSERT_EQ(run_engram(import_arguments(recording, store_, start)).exit_code, 0);
  }

  [[nodiscard]] RunResult crossval(const std::vector<std::string>& more) const {
    std::vector<std::string> all{"crossval", store_,    "--entity", kCamera,     "--width",
                                 "32",       "--steps", "5",        "--threads", "1"};
    all.insert(all.end(), more.begin(), more.end());
    return run_engram(all);
  }

  ScratchDirectory directory_;
  std::string store_ = directory_.path() / "robot.engram";
};

TEST_F(CrossvalCommand, TellsEachFoldAndThenAllOfThem) {
  const RunResult shown = crossval({});
  ASSERT_EQ(shown.exit_code, 0) << shown.err;
  EXPECT_THAT(shown.err, AllOf(HasSubstr("fold 1, rate, left out 2022-02-18 13:00:00"),
                               HasSubstr("fold 2, rate, left out 2022-02-18 14:00:00")));
  EXPECT_THAT(shown.out, AllOf(HasSubstr("trained - left"), HasSubstr("told what came as a plan"),
                               HasSubstr("over all folds"), HasSubstr("copy-last"),
                               Not(HasSubstr("with residuals"))));
}

TEST_F(CrossvalCommand, TakesTheWordsOfEarlierVersions) {
  const RunResult shown = crossval({"--fold", "2", "--ahead", "2", "--every", "0s"});
  ASSERT_EQ(shown.exit_code, 0) << shown.err;
  EXPECT_THAT(shown.err, AllOf(HasSubstr("'--ahead' is '--max-horizon' now"),
                               HasSubstr("'--every' is '--spacing' now")));
}

TEST_F(CrossvalCommand, PutsResidualsBesideLatentsAlone) {
  const RunResult shown = crossval({"--fold", "2", "--bound", "25"});
  ASSERT_EQ(shown.exit_code, 0) << shown.err;
  EXPECT_THAT(shown.err, HasSubstr("; with residuals "));
  EXPECT_THAT(shown.out, HasSubstr("with residuals below 25.0 dB"));
  const RunResult as_json = crossval({"--fold", "2", "--bound", "25", "--json"});
  ASSERT_EQ(as_json.exit_code, 0) << as_json.err;
  const Json rate = Json::parse(as_json.out).at("all").at("variants").at("rate");
  EXPECT_LT(rate.at("left_out").at("mean_psnr_db").get<double>(), 25);
  EXPECT_GE(rate.at("corrected").at("left_out").at("mean_psnr_db").get<double>(), 25);
  EXPECT_GT(rate.at("corrected").at("left_out_bytes").get<double>(),
            rate.at("left_out_bytes").get<double>());
}

TEST_F(CrossvalCommand, RefusesWhatCannotBe) {
  EXPECT_EQ(crossval({"--bound", "5"}).exit_code, 2);
  EXPECT_EQ(crossval({"--variants", "best"}).exit_code, 2);
  const RunResult third = crossval({"--fold", "3"});
  EXPECT_EQ(third.exit_code, 1);
  EXPECT_THAT(third.err, HasSubstr("it has 2 recordings"));
}

}  // namespace
}  // namespace engram::cli
