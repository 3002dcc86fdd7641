// SPDX-License-Identifier: Apache-2.0
// `engram import` with configurations and presets.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/cli/run_program.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::cli {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using Json = nlohmann::json;

class ImportConfig : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    directory_ = new ScratchDirectory();
    recording_ = make_recording(directory_->path(), 6);
  }
  static void TearDownTestSuite() { delete directory_; }

  /// An import of the recording with `extra` arguments instead of --rate.
  static RunResult import(const std::string& store, const std::vector<std::string>& extra) {
    std::vector<std::string> arguments = import_arguments(recording_, directory_->path() / store);
    const auto rate = std::ranges::find(arguments, "--rate");
    if (rate != arguments.end()) arguments.erase(rate, rate + 2);
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    return run_engram(arguments);
  }
  static std::string write(const std::string& name, const std::string& text) {
    const std::string path = directory_->path() / name;
    std::ofstream(path) << text;
    return path;
  }
  static Json entity(const RunResult& result, const std::string& id) {
    EXPECT_EQ(result.exit_code, 0) << result.err;
    const Json report = Json::parse(result.out);
    for (const Json& each : report.at("entities"))
      if (each.at("entity") == id) return each;
    return {};
  }

  static inline ScratchDirectory* directory_ = nullptr;
  static inline Recording recording_;
};

TEST_F(ImportConfig, ADryRunListsWhatIsInAVideoAndMakesNoStore) {
  const RunResult result = import("dry", {"--dry-run", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json report = Json::parse(result.out);
  EXPECT_EQ(report.at("format"), "video");
  ASSERT_EQ(report.at("streams").size(), 2u);
  EXPECT_GT(report.at("streams")[0].at("values"), 0);
  EXPECT_FALSE(std::filesystem::exists(directory_->path() / "dry"));
}

TEST_F(ImportConfig, CountsPerFilterAndReason) {
  const std::string config = write("rec.yaml", R"(entities:
  - match: Vision
    name: cameras
    filters:
      - frequency: {rate: 5Hz}
      - similarity: {images: {measure: ssim, bound: -1}, max_gap: 2s}
  - match: .*
    filters: [equality]
)");
  const Json camera = entity(import("config", {"--config", config, "--json"}), kCamera);
  EXPECT_EQ(camera.at("rule"), "cameras");
  EXPECT_EQ(camera.at("offered"), 90);
  const Json& frequency = camera.at("filters").at(0);
  EXPECT_EQ(frequency.at("filter"), "frequency");
  EXPECT_EQ(frequency.at("kept"), 30);
  EXPECT_EQ(frequency.at("dropped_by").at("rate"), 60);
  EXPECT_EQ(camera.at("filters").at(1).at("offered"), 30);
  EXPECT_EQ(camera.at("held"), 0);
  EXPECT_EQ(camera.at("kept").get<int>() + camera.at("dropped_by").at("frequency").get<int>() +
                camera.at("dropped_by").value("similarity", 0),
            90);
}

TEST_F(ImportConfig, TakesPresetsAndPrintsThem) {
  EXPECT_EQ(entity(import("all", {"--preset", "recorder", "--json"}), kCamera).at("kept"), 90);
  const RunResult printed = run_engram({"import", "--print-preset", "small"});
  EXPECT_EQ(printed.exit_code, 0) << printed.err;
  EXPECT_THAT(printed.out, HasSubstr("frequency: {rate: 5Hz}"));
  const std::string config = write("printed.yaml", printed.out);
  const RunResult imported = import("printed", {"--config", config});
  EXPECT_EQ(imported.exit_code, 0) << imported.err;
  EXPECT_THAT(imported.out, AllOf(HasSubstr("rule 'everything'"), HasSubstr("frequency (rate ")));
}

TEST_F(ImportConfig, NamesWhatIsWrong) {
  const std::string config = write("bad.yaml", "entities:\n  - mach: .*\n    match: .*\n");
  const RunResult bad = import("none", {"--config", config});
  EXPECT_EQ(bad.exit_code, 2);
  EXPECT_THAT(bad.err, AllOf(HasSubstr("bad.yaml:2"), HasSubstr("'match'?")));
  EXPECT_EQ(import("none", {"--config", "/nonexistent.yaml"}).exit_code, 2);
  const RunResult preset = import("none", {"--preset", "tiny"});
  EXPECT_EQ(preset.exit_code, 2);
  EXPECT_THAT(preset.err, HasSubstr("balanced"));
  EXPECT_EQ(run_engram({"import", "--print-preset", "tiny"}).exit_code, 2);
  EXPECT_EQ(import("none", {"--preset", "small", "--rate", "3"}).exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(directory_->path() / "none"));
}

}  // namespace
}  // namespace engram::cli
