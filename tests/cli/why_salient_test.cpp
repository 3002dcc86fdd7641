// SPDX-License-Identifier: Apache-2.0
// `engram why-salient`: what it explains, keeps and refuses; nights make it; forgetting uses it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/cli/run_program.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::cli {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;

class WhySalientCommand : public ::testing::Test {
 protected:
  WhySalientCommand() {
    const Recording recording = make_recording(directory_.path(), 8);
    EXPECT_EQ(run_engram(import_arguments(recording, store_, "2022-02-18 13:00:00")).exit_code, 0);
  }

  [[nodiscard]] static Json told(const RunResult& result) {
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return Json::parse(result.out, nullptr, false);
  }

  ScratchDirectory directory_;
  std::string store_ = directory_.path() / "store";
  const std::string moment_ = kCamera + "/2022-02-18 13:00:05";
};

TEST_F(WhySalientCommand, ExplainsKeepsAndForgets) {
  const Json before = told(run_engram({"why-salient", store_, moment_, "--json"}));
  EXPECT_EQ(before.at("is_stored"), false);
  const Json kept = told(run_engram({"why-salient", store_, moment_, "--keep", "--json"}));
  EXPECT_EQ(kept.at("id"), kCamera + "/2022-02-18 13:00:05.000000");
  EXPECT_EQ(kept.at("is_stored"), true);
  EXPECT_EQ(kept.at("count"), 40);
  ASSERT_EQ(kept.at("parts").size(), 7u);
  double sum = 0;
  for (const Json& part : kept.at("parts")) sum += part.at("contribution").get<double>();
  EXPECT_NEAR(kept.at("saliency").get<double>(), sum, 1e-9);
  const RunResult text = run_engram({"why-salient", store_, kCamera});
  EXPECT_THAT(text.out, HasSubstr("2022-02-18 13:00:07.800000\nsaliency 0."));
  EXPECT_THAT(text.out, HasSubstr("weights: the standard ones"));
  EXPECT_EQ(run_engram({"check", store_}).exit_code, 0);
  const std::string config = directory_.path() / "forget.yaml";
  std::ofstream(config) << "forget: {rules: [{saliency: {keep: 0.25}}], protect: {newest: 0}}";
  EXPECT_EQ(run_engram({"forget", store_, "--config", config, "--yes"}).exit_code, 0);
  const RunResult left = run_engram({"why-salient", store_, kCamera, "--json"});
  EXPECT_NEAR(told(left).at("count").get<double>(), 10, 1);
}

TEST_F(WhySalientCommand, NightsMakeItAndItStaysWithLatents) {
  const RunResult night = run_engram({"consolidate", store_, "--representation", "video",
                                      "--entity", kCamera, "--drop-raw", "--json"});
  EXPECT_EQ(told(night).at("saliency").at("snapshots"), 40);
  const Json after = told(run_engram({"why-salient", store_, moment_, "--json"}));
  EXPECT_EQ(after.at("is_stored"), true);
}

TEST_F(WhySalientCommand, SaysWhatIsWrong) {
  const auto refuses = [this](const std::string& moment, int code, const char* why) {
    const RunResult result = run_engram({"why-salient", store_, moment});
    EXPECT_EQ(result.exit_code, code) << result.err;
    EXPECT_THAT(result.err, HasSubstr(why));
  };
  refuses(kCamera + "/2022-02-18 13:00:05.1", 1, "has no snapshot at 2022-02-18 13:00:05.100000");
  refuses("Vision/RGB/head/other", 1, "Vision/RGB/head/other");
  refuses("Vision/RGB", 2, "needs a moment or an entity");
  EXPECT_EQ(run_engram({"why-salient", store_ + "x", moment_}).exit_code, 1);
}

}  // namespace
}  // namespace engram::cli
