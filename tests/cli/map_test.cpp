// SPDX-License-Identifier: Apache-2.0
// `engram map`: maps are made of what a store knows, written, read back and refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "ltm/core/time.h"
#include "ltm/recording/recorder.h"
#include "tests/cli/run_program.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/server/navigation/floor_example.h"

namespace engram::cli {
namespace {

using navigation::testing::class_of;
using navigation::testing::kBegin;
using navigation::testing::surface_at;
using navigation::testing::thing_at;
using std::chrono::seconds;
using ::testing::HasSubstr;
using Json = nlohmann::json;

class MapCommand : public ::testing::Test {
 protected:
  MapCommand() {
    auto recorder = ltm::Recorder::open(store_, {});
    ENGRAM_CHECK(recorder.ok(), "{}", recorder.status().message());
    record(*recorder, class_of("chair", "box", 0.5, 0.5, 0.9));
    record(*recorder, surface_at("table", {2, 0, 0}, 0.75, 0.8, 1.4));
    record(*recorder, thing_at("chair_1", "chair", {-2, 0, 0}, 0.45, kBegin));
    record(*recorder, thing_at("chair_1", "chair", {-1, 0, 0}, 0.45, kBegin + seconds(10)));
    record(*recorder, thing_at("box_1", "unheard", {0, 3, 0}, 0.1, kBegin));
    ENGRAM_CHECK(recorder->close().ok(), "not closed");
  }

  static void record(ltm::Recorder& recorder, const ltm::Snapshot& snapshot) {
    const auto status = recorder.commit({{snapshot}});
    ENGRAM_CHECK(status.ok(), "not recorded");
  }

  [[nodiscard]] static Json told(const RunResult& result) {
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return Json::parse(result.out, nullptr, false);
  }

  [[nodiscard]] static std::string text_of(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
  }

  ScratchDirectory directory_;
  std::string store_ = directory_.path() / "store";
  std::string yaml_ = directory_.path() / "floor.yaml";
};

TEST_F(MapCommand, MakesWritesAndReadsMaps) {
  const Json made = told(run_engram({"map", "make", store_, "--json"}));
  EXPECT_EQ(made.at("map"), "Navigation/CostMap/navigation/floor/2023-11-14 22:13:30.000000/0");
  EXPECT_EQ(made.at("made_of").size(), 2u);
  EXPECT_THAT(made.at("left_out").at(0).at("reason"), HasSubstr("is not known"));
  const Json written = told(run_engram({"map", "export", store_, "--out", yaml_, "--json"}));
  EXPECT_EQ(written.at("obstacle_cells"), made.at("obstacle_cells"));
  EXPECT_THAT(text_of(yaml_), HasSubstr("image: \"floor.pgm\"\nmode: trinary\nresolution: 0.05"));
  const std::string picture = text_of(directory_.path() / "floor.pgm");
  EXPECT_EQ(picture.size(), std::string("P5\n200 200\n255\n").size() + 200 * 200);
  const Json read =
      told(run_engram({"map", "import", store_, yaml_, "--map", "building/ground", "--json"}));
  EXPECT_EQ(read.at("obstacle_cells"), made.at("obstacle_cells"));
  EXPECT_EQ(read.at("unknown_cells"), 0);
  EXPECT_EQ(run_engram({"map", "export", store_, "--map", "building/ground", "--out", yaml_,
                        "--pixels", "raw"})
                .exit_code,
            0);
  EXPECT_EQ(run_engram({"check", store_}).exit_code, 0);
}

TEST_F(MapCommand, MakesMapsOfThePast) {
  const Json past =
      told(run_engram({"map", "make", store_, "--at", "2023-11-14 22:13:25", "--json"}));
  EXPECT_EQ(past.at("map"), "Navigation/CostMap/navigation/floor/2023-11-14 22:13:20.000000/0");
  EXPECT_EQ(run_engram({"map", "make", store_}).exit_code, 0);
  const Json before = told(run_engram(
      {"map", "export", store_, "--at", "2023-11-14 22:13:29", "--out", yaml_, "--json"}));
  EXPECT_EQ(before.at("map"), past.at("map"));
}

TEST_F(MapCommand, SaysWhatIsWrong) {
  const auto refuses = [](const std::vector<std::string>& arguments, int code, const char* why) {
    const RunResult result = run_engram(arguments);
    EXPECT_EQ(result.exit_code, code) << result.err;
    EXPECT_THAT(result.err, HasSubstr(why));
  };
  refuses({"map", "export", store_, "--out", yaml_}, 1, "Navigation/CostMap/navigation/floor");
  refuses({"map", "export", store_, "--out", yaml_, "--map", "floor"}, 2, "needs PROVIDER/NAME");
  refuses({"map", "export", store_}, 2, "--out");
  refuses({"map", "export", store_, "--out", yaml_, "--pixels", "fuzzy"}, 2, "fuzzy");
  refuses({"map", "import", store_, yaml_}, 1, "floor.yaml");
  std::ofstream(yaml_) << "image: floor.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n";
  std::ofstream(directory_.path() / "floor.pgm") << "P5 100 100 255\ntoo short";
  refuses({"map", "import", store_, yaml_}, 1, "need 10001");
  refuses({"map"}, 2, "subcommand");
  const std::string empty = directory_.path() / "empty";
  refuses({"map", "make", empty}, 1, "no objects and no furniture");
}

}  // namespace
}  // namespace engram::cli
