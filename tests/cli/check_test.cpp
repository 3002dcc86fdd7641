// SPDX-License-Identifier: Apache-2.0
// `engram check` and `engram recover`: what they print, and their exit codes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "ltm/recording/recorder.h"
#include "tests/cli/run_program.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::cli {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;

constexpr int kFailed = 1;
constexpr int kWrongUsage = 2;
constexpr int kDoneWithLoss = 3;
constexpr int kSnapshots = 20;

/// A store of one sealed segment; its times are 1, 2, ... ns.
class CheckCommand : public ::testing::Test {
 protected:
  CheckCommand() {
    auto recorder = ltm::Recorder::open(store_, {});
    EXPECT_TRUE(recorder.ok()) << recorder.status().to_string();
    const auto entity = ltm::MemoryId::parse(kCamera).value();
    for (int i = 1; i <= kSnapshots; ++i)
      EXPECT_TRUE(
          recorder->commit({{{entity, time_from_ns(i), {{std::string(500, 'x'), {}}}}}}).ok());
    EXPECT_TRUE(recorder->close().ok());
  }

  [[nodiscard]] std::string path(const std::string& name) const { return directory_.path() / name; }

  void cut(const std::string& file, uint64_t bytes) const {
    std::filesystem::resize_file(path("store/" + file), bytes);
  }

  ScratchDirectory directory_;
  std::string store_ = path("store");
};

TEST_F(CheckCommand, SaysThatAWholeStoreIsWhole) {
  const RunResult text = run_engram({"check", store_, "--deep"});
  EXPECT_EQ(text.exit_code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("It is whole."));
  const RunResult json = run_engram({"check", store_, "--json"});
  EXPECT_EQ(json.exit_code, 0);
  EXPECT_EQ(Json::parse(json.out).at("clean"), true);
  EXPECT_EQ(Json::parse(json.out).at("snapshots"), kSnapshots);
}

TEST_F(CheckCommand, TellsDamageAndHowToGoOn) {
  cut("segments/000001.h5", 1000);
  const RunResult text = run_engram({"check", store_});
  EXPECT_EQ(text.exit_code, kDoneWithLoss);
  EXPECT_THAT(text.out, HasSubstr("segments/000001.h5"));
  EXPECT_THAT(text.out, HasSubstr("engram recover"));
  const RunResult json = run_engram({"check", store_, "--json"});
  EXPECT_EQ(json.exit_code, kDoneWithLoss);
  EXPECT_EQ(Json::parse(json.out).at("findings").at(0).at("severity"), "fault");
}

TEST_F(CheckCommand, FailsWhereThereIsNoStore) {
  const RunResult result = run_engram({"check", path("none")});
  EXPECT_EQ(result.exit_code, kFailed);
  EXPECT_THAT(result.err, HasSubstr("none"));
}

TEST_F(CheckCommand, RecoverCountsWhatItLost) {
  cut("segments/000001.h5", 1000);
  const RunResult result = run_engram({"recover", store_, "-o", path("copy"), "--json"});
  EXPECT_EQ(result.exit_code, kDoneWithLoss) << result.err;
  const Json json = Json::parse(result.out);
  EXPECT_EQ(json.at("lossless"), false);
  EXPECT_EQ(json.at("entities").at(0).at("recorded_lost"), kSnapshots);
  EXPECT_EQ(run_engram({"check", path("copy")}).exit_code, 0);
}

TEST_F(CheckCommand, RecoverSavesAllWithoutAManifest) {
  std::filesystem::remove(store_ + "/MANIFEST.json");
  EXPECT_EQ(run_engram({"check", store_}).exit_code, kDoneWithLoss);
  const RunResult result = run_engram({"recover", store_, "-o", path("copy")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("Nothing was lost."));
  const RunResult copy = run_engram({"check", path("copy"), "--json"});
  EXPECT_EQ(Json::parse(copy.out).at("snapshots"), kSnapshots);
}

TEST_F(CheckCommand, RecoverIsNeverInPlace) {
  EXPECT_EQ(run_engram({"recover", store_}).exit_code, kWrongUsage);
  EXPECT_EQ(run_engram({"recover", store_, "-o", store_}).exit_code, kFailed);
  std::filesystem::create_directory(path("copy"));
  const RunResult result = run_engram({"recover", store_, "-o", path("copy")});
  EXPECT_EQ(result.exit_code, kFailed);
  EXPECT_THAT(result.err, HasSubstr("there already"));
}

}  // namespace
}  // namespace engram::cli
