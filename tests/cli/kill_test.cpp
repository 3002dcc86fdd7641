// SPDX-License-Identifier: Apache-2.0
// kill -9 while the program works: the memory stays whole.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/cli/run_program.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::cli {
namespace {

using Json = nlohmann::json;

/// What `info` says of the camera: fails the test where the store cannot be read.
Json camera_info(const std::string& store) {
  const RunResult info = run_engram({"info", store, "--json"});
  EXPECT_EQ(info.exit_code, 0) << info.err;
  const Json json = Json::parse(info.out);
  for (const Json& entity : json.at("entities"))
    if (entity.at("id") == kCamera) return entity;
  return Json{{"snapshots", 0}, {"latent_snapshots", 0}};
}

TEST(KillDuringImport, LeavesAGaplessBeginningThatAnswers) {
  const ScratchDirectory directory;
  const Recording recording = make_recording(directory.path(), 40);
  int killed = 0;
  for (int round = 0; round < 8; ++round) {
    const std::string store = directory.path() / ("store" + std::to_string(round));
    const RunResult result =
        run_engram_and_kill(import_arguments(recording, store), 60 + 70 * round);
    if (result.exit_code == 0) break;
    ++killed;
    // Killed before the store was made: there is nothing to lose yet.
    if (!std::filesystem::exists(store + "/MANIFEST.json")) continue;
    const auto snapshots = camera_info(store).at("snapshots").get<int64_t>();
    if (snapshots == 0) continue;
    const RunResult all = run_engram({"query", store, kCamera + " @ all", "--json"});
    ASSERT_EQ(all.exit_code, 0) << all.err;
    const Json found = Json::parse(all.out).at("entities").at(0).at("snapshots");
    ASSERT_EQ(found.size(), static_cast<size_t>(snapshots));
    for (size_t i = 0; i < found.size(); ++i)
      EXPECT_EQ(found[i].at("time_ns").get<int64_t>() - found[0].at("time_ns").get<int64_t>(),
                static_cast<int64_t>(i) * 200'000'000);
    // The next session goes on behind what is there.
    const auto next = import_arguments(recording, store, "2022-02-18 14:00:00");
    EXPECT_EQ(run_engram(next).exit_code, 0);
    EXPECT_EQ(camera_info(store).at("snapshots").get<int64_t>(), snapshots + 200);
  }
  EXPECT_GT(killed, 0);
}

TEST(KillDuringConsolidation, LeavesTheRecordedMemoryAsItWas) {
  const ScratchDirectory directory;
  const std::string store = directory.path() / "robot.engram";
  ASSERT_EQ(run_engram(import_arguments(make_recording(directory.path(), 8), store)).exit_code, 0);
  const std::vector<std::string> consolidate{"consolidate", store,     "--representation", "latents",
                                             "--steps",     "40",      "--threads",        "1",
                                             "--force"};
  int killed = 0;
  for (const int milliseconds : {100, 700, 1500, 2500, 4000}) {
    killed += run_engram_and_kill(consolidate, milliseconds).exit_code < 0 ? 1 : 0;
    const Json camera = camera_info(store);
    EXPECT_EQ(camera.at("snapshots"), 40);
    EXPECT_EQ(camera.at("recorded_snapshots"), 40);
    EXPECT_THAT(camera.at("latent_snapshots").get<int>(), ::testing::AnyOf(0, 40));
    EXPECT_EQ(run_engram({"query", store, kCamera + " @ latest:3"}).exit_code, 0);
    EXPECT_EQ(run_engram({"query", store, kCamera + " @ +200ms"}).exit_code, 0);
  }
  EXPECT_GT(killed, 0);
  const RunResult done = run_engram(consolidate);
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_EQ(camera_info(store).at("latent_snapshots"), 40);
}

}  // namespace
}  // namespace engram::cli
