// SPDX-License-Identifier: Apache-2.0
// `engram simulate kitchen`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>

#include "tests/cli/run_program.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::cli {
namespace {

using ::testing::HasSubstr;

/// By path, without the manifest, which names the store by chance.
std::map<std::string, std::string> files_of(const std::filesystem::path& store) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(store)) {
    if (!entry.is_regular_file() || entry.path().filename() == "MANIFEST.json") continue;
    std::ifstream file(entry.path(), std::ios::binary);
    files[entry.path().lexically_relative(store)] = {std::istreambuf_iterator<char>(file), {}};
  }
  return files;
}

TEST(SimulateKitchen, RecordsSeedsInProcessesBesideEachOtherAndEqualSeedsEqually) {
  const ScratchDirectory directory;
  const std::string folder = directory / "episodes";
  const RunResult both = run_engram({"simulate", "kitchen", "--folder", folder, "--seed", "1,2",
                                     "--jobs", "2", "--fast", "--seconds", "2"});
  ASSERT_EQ(both.exit_code, 0) << both.err;
  EXPECT_THAT(both.out, HasSubstr("kitchen-1.engram: seed 1, 40 stereo images in 2 s"));
  EXPECT_THAT(both.out, HasSubstr("kitchen-2.engram: seed 2"));

  const std::string alone = directory / "alone.engram";
  ASSERT_EQ(run_engram({"simulate", "kitchen", alone, "--seed", "2", "--fast", "--seconds", "2"})
                .exit_code,
            0);
  const auto files = files_of(alone);
  EXPECT_GE(files.size(), 1u);
  EXPECT_TRUE(files == files_of(folder + "/kitchen-2.engram"));
  EXPECT_FALSE(files == files_of(folder + "/kitchen-1.engram"));

  const RunResult checked = run_engram({"check", alone});
  EXPECT_EQ(checked.exit_code, 0) << checked.err;
  const RunResult asked = run_engram({"query", alone, "Speech @ all", "--json"});
  EXPECT_EQ(asked.exit_code, 0) << asked.err;
  EXPECT_THAT(asked.out, HasSubstr("2026-01-01 09:00:00.5"));
  EXPECT_THAT(run_engram({"query", alone, "Speech @ all"}).out, HasSubstr(R"("text":")"))
      << "shown, however long it is";
}

TEST(SimulateKitchen, RecordsAllButImages) {
  const ScratchDirectory directory;
  const std::string store = directory / "plain.engram";
  const RunResult made =
      run_engram({"simulate", "kitchen", store, "--no-images", "--seconds", "2"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("plain.engram: seed 1, 0 stereo images in 2 s"));
  // Links that lead to nothing would be noted.
  const RunResult checked = run_engram({"check", store, "--json"});
  EXPECT_EQ(checked.exit_code, 0) << checked.err;
  EXPECT_EQ(nlohmann::json::parse(checked.out)["findings"].size(), 0U) << checked.out;
  const RunResult asked = run_engram({"query", store, "Vision @ all"});
  EXPECT_EQ(asked.exit_code, 1);
  EXPECT_THAT(asked.err, HasSubstr("no entity matches"));
  EXPECT_THAT(run_engram({"query", store, "Simulation @ all", "--json"}).out,
              HasSubstr(R"("has_images": false)"));
  const RunResult deep = run_engram({"simulate", "kitchen", store, "--no-images", "--depth"});
  EXPECT_EQ(deep.exit_code, 2);
  EXPECT_THAT(deep.err, HasSubstr("depth without images"));
  EXPECT_EQ(run_engram({"simulate", "kitchen", "--live", "--no-images"}).exit_code, 2);
}

TEST(SimulateKitchen, GivesThingsColours) {
  const ScratchDirectory directory;
  const std::string store = directory / "coloured.engram";
  const RunResult made =
      run_engram({"simulate", "kitchen", store, "--colours", "--no-images", "--seconds", "1"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const RunResult asked = run_engram({"query", store, "Objects/Instances @ latest", "--json"});
  EXPECT_THAT(asked.out, HasSubstr(R"("colour": ")"));
  // What was recorded without colours has another type.
  EXPECT_EQ(run_engram({"simulate", "kitchen", "--live", "--colours"}).exit_code, 2);
}

TEST(SimulateKitchen, WritesPlainFiles) {
  const ScratchDirectory directory;
  const std::string folder = directory / "plain";
  const std::vector<std::string> words{"simulate", "kitchen", "--folder",  folder,
                                       "--plain",  "--fast",  "--seconds", "1"};
  const RunResult made = run_engram(words);
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("kitchen-1: seed 1, 20 stereo images"));
  const auto files = files_of(folder + "/kitchen-1");
  const auto count = [&](const std::string& name, const std::string& end) {
    return std::ranges::count_if(files, [&](const auto& file) {
      return file.first.starts_with(name) && file.first.ends_with(end);
    });
  };
  EXPECT_EQ(count("Vision/RGB/head/stereo/", "image.png"), 40);
  EXPECT_EQ(count("RobotState/Proprioception/robot/joints/", "data.json"), 100);
  EXPECT_EQ(count("Speech/", "data.json"), 1);
  // Files that are there are not written over.
  EXPECT_EQ(run_engram(words).exit_code, 1);
  const RunResult lost = run_engram({"simulate", "kitchen", directory / "x", "--plain"});
  EXPECT_EQ(lost.exit_code, 2);
}

TEST(SimulateKitchen, SaysWhatIsWrong) {
  const ScratchDirectory directory;
  const std::string store = directory / "k.engram";
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
      {{}, "needs a STORE or --folder"},
      {{store, "--seed", "5..1"}, "--seed '5..1'"},
      {{store, "--seed", "0"}, "--seed '0'"},
      {{store, "--seed", "1x"}, "--seed '1x'"},
      {{store, "--seed", "1..2", "--jobs", "2"}, "needs --folder"},
      {{store, "--width", "33"}, "33 x 480"},
      {{store, "--preset", "huge"}, "huge"}};
  for (const auto& [more, message] : cases) {
    std::vector<std::string> arguments{"simulate", "kitchen"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const RunResult result = run_engram(arguments);
    EXPECT_EQ(result.exit_code, 2) << message;
    EXPECT_THAT(result.err, HasSubstr(message));
    EXPECT_FALSE(std::filesystem::exists(store));
  }
}

}  // namespace
}  // namespace engram::cli
