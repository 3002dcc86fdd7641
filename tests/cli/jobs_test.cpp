// SPDX-License-Identifier: Apache-2.0
// `engram consolidate --jobs`: entities in processes of their own.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "tests/cli/run_program.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::cli {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;

class Jobs : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto recording = make_recording(directory_.path(), 8);
    ASSERT_EQ(run_engram(import_arguments(recording, store_)).exit_code, 0);
  }

  [[nodiscard]] std::vector<std::string> job(const std::vector<std::string>& more) const {
    std::vector<std::string> all{"consolidate",      store_,   "--width", "32",
                                 "--representation", "latents"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }

  ScratchDirectory directory_;
  std::string store_ = directory_.path() / "robot.engram";
};

/// Processes whose arguments name a path.
size_t processes_of(const std::string& path) {
  size_t count = 0;
  for (const auto& process : std::filesystem::directory_iterator("/proc")) {
    std::ifstream file(process.path() / "cmdline");
    const std::string arguments{std::istreambuf_iterator<char>(file), {}};
    if (arguments.find(path) != std::string::npos) ++count;
  }
  return count;
}

TEST_F(Jobs, TrainEntitiesInTwoProcessesToTheSameModelsAsOne) {
  const std::string other = directory_.path() / "other.engram";
  std::filesystem::copy(store_, other, std::filesystem::copy_options::recursive);
  const RunResult two = run_engram(job({"--steps", "20", "--jobs", "2", "--json"}));
  ASSERT_EQ(two.exit_code, 0) << two.err;
  const Json report = Json::parse(two.out);
  ASSERT_EQ(report.at("entities").size(), 2u);
  EXPECT_EQ(report.at("entities").at(0).at("entity"), kJoints) << "in the order of the plan";
  EXPECT_EQ(report.at("entities").at(1).at("entity"), kCamera);
  EXPECT_EQ(report.at("plan").at("entities").size(), 2u);
  EXPECT_THAT(two.err, HasSubstr("train " + kCamera));
  EXPECT_THAT(two.err, HasSubstr("train " + kJoints));
  EXPECT_EQ(run_engram({"check", store_}).exit_code, 0);

  // One process of one thread makes the same latents and says the same of them.
  std::vector<std::string> in_one =
      job({"--steps", "20", "--threads", "1", "--jobs", "1", "--json"});
  in_one[1] = other;
  const Json one = Json::parse(run_engram(in_one).out);
  for (const size_t i : {0, 1})
    for (const char* what : {"latent_bytes", "psnr_mean_over_images_db", "rmse"})
      EXPECT_EQ(one.at("entities").at(i).at(what), report.at("entities").at(i).at(what)) << what;
}

TEST_F(Jobs, TellOnePlanAndEveryReport) {
  const RunResult shown = run_engram(job({"--steps", "5", "--jobs", "2"}));
  ASSERT_EQ(shown.exit_code, 0) << shown.err;
  EXPECT_THAT(shown.out, HasSubstr(kCamera + " v1: 40 snapshots"));
  EXPECT_THAT(shown.out, HasSubstr(kJoints + " v1: 40 snapshots"));
  const size_t plan = shown.out.find("snapshots  new");
  EXPECT_NE(plan, std::string::npos) << shown.out;
  EXPECT_EQ(shown.out.find("snapshots  new", plan + 1), std::string::npos) << shown.out;
}

TEST_F(Jobs, FailWhereAPartFails) {
  const RunResult failed =
      run_engram(job({"--steps", "5", "--jobs", "2", "--yield-command", "/nowhere/busy"}));
  EXPECT_EQ(failed.exit_code, 1);
  EXPECT_THAT(failed.err, HasSubstr("cannot be run"));
  EXPECT_EQ(run_engram(job({"--steps", "5", "--jobs", "3"})).exit_code, 2);
}

// The moment is passed on as text, which must not be taken for local time.
TEST_F(Jobs, EndAtTheSameMomentInEveryTimeZone) {
  const auto before =
      std::getenv("TZ") != nullptr ? std::optional<std::string>(std::getenv("TZ")) : std::nullopt;
  for (const char* zone : {"UTC+11", "UTC-11"}) {
    ::setenv("TZ", zone, 1);
    const auto start = std::chrono::steady_clock::now();
    const RunResult done = run_engram(job({"--budget", "10s", "--jobs", "2", "--force"}));
    EXPECT_EQ(done.exit_code, 0) << zone << ": " << done.err;
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::minutes(2)) << zone;
  }
  if (before)
    ::setenv("TZ", before->c_str(), 1);
  else
    ::unsetenv("TZ");
}

TEST_F(Jobs, EndWithTheirParent) {
  const auto arguments = job({"--training", "10m", "--jobs", "2", "--checkpoint-every", "100ms"});
  RunResult killed;
  for (int i = 0; i < 10 && killed.err.find("goes on from") == std::string::npos; ++i) {
    killed = run_engram_and_kill(arguments, 6000);
    ASSERT_EQ(killed.exit_code, -9) << killed.err;
  }
  for (int i = 0; i < 100 && processes_of(store_) > 0; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_EQ(processes_of(store_), 0u);
  // Training goes on where it was, in one process as well as in two.
  const RunResult again = run_engram(job({"--training", "2s", "--threads", "2"}));
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_THAT(again.err, HasSubstr("training goes on from a checkpoint"));
  EXPECT_EQ(run_engram({"check", store_}).exit_code, 0);
}

}  // namespace
}  // namespace engram::cli
