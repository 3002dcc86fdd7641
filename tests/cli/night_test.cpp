// SPDX-License-Identifier: Apache-2.0
// `engram consolidate` as a nightly job: what it plans, tells, obeys and goes on from.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "ltm/store/manifest.h"
#include "tests/cli/run_program.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::cli {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using Json = nlohmann::json;

constexpr int kWrongUsage = 2;

class NightJob : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto recording = make_recording(directory_.path(), 8);
    ASSERT_EQ(run_engram(import_arguments(recording, store_)).exit_code, 0);
  }

  [[nodiscard]] std::vector<std::string> job(std::vector<std::string> more) const {
    std::vector<std::string> all{"consolidate", store_, "--entity",         kCamera,
                                 "--width",     "32",   "--representation", "latents",
                                 "--threads",   "1"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }

  [[nodiscard]] uint64_t generation() const { return ltm::read_manifest(store_)->generation; }

  ScratchDirectory directory_;
  std::string store_ = directory_.path() / "robot.engram";
};

/// The lines of JSON among those of stderr.
std::vector<Json> progress_of(const RunResult& result) {
  std::vector<Json> found;
  std::istringstream lines(result.err);
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with("{")) found.push_back(Json::parse(line));
  return found;
}

TEST_F(NightJob, DryRunPlansAndChangesNothing) {
  const uint64_t before = generation();
  const RunResult told = run_engram(job({"--dry-run", "--json"}));
  ASSERT_EQ(told.exit_code, 0) << told.err;
  const Json plan = Json::parse(told.out);
  ASSERT_EQ(plan.at("entities").size(), 1u);
  const Json& camera = plan.at("entities").at(0);
  EXPECT_EQ(camera.at("snapshots"), 40);
  EXPECT_EQ(camera.at("new_snapshots"), 40);
  EXPECT_GE(camera.at("plain_bytes").get<int64_t>(), 40 * 64 * 64 * 3);
  EXPECT_EQ(camera.at("budget_share"), 1.0);
  EXPECT_EQ(camera.at("expected_gain_bytes"), nullptr);
  EXPECT_THAT(run_engram(job({"--dry-run"})).out, AllOf(HasSubstr("plan"), HasSubstr(kCamera)));
  EXPECT_EQ(generation(), before);
}

TEST_F(NightJob, TellsItsPlanThenProgressAsJsonWhereNoTerminalIs) {
  const RunResult done = run_engram(job({"--steps", "5", "--json"}));
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_EQ(Json::parse(done.out).at("plan").at("entities").at(0).at("snapshots"), 40);
  const auto progress = progress_of(done);
  ASSERT_FALSE(progress.empty());
  for (const Json& line : progress)
    for (const char* key : {"time", "what", "done", "total", "detail", "seconds_left"})
      EXPECT_TRUE(line.contains(key)) << key;
  EXPECT_EQ(progress.front().at("what"), "train " + kCamera);
  EXPECT_TRUE(std::ranges::any_of(progress, [](const Json& line) {
    return line.at("what") == "encode " + kCamera && line.at("done") == 40;
  }));
  EXPECT_TRUE(std::ranges::any_of(progress, [](const Json& line) {
    return line.at("what") == "code images of " + kCamera && line.at("done") == 40;
  }));
  EXPECT_EQ(progress.back().at("what"), "calculate saliency");
  EXPECT_EQ(progress.back().at("done"), 40);
  EXPECT_EQ(progress.back().at("total"), 40);
  const RunResult plain = run_engram(job({"--steps", "5", "--force", "--progress", "line"}));
  EXPECT_TRUE(progress_of(plain).empty());
  EXPECT_THAT(plain.err, HasSubstr("encode " + kCamera));
  const RunResult none = run_engram(job({"--steps", "5", "--force", "--progress", "none"}));
  EXPECT_EQ(none.err, "");
}

TEST_F(NightJob, RefusesTimesThatCannotBe) {
  for (const auto& wrong :
       std::vector<std::vector<std::string>>{{"--until", "06:00", "--budget", "5m"},
                                             {"--until", "06:00", "--training", "5m"},
                                             {"--budget", "5m", "--training", "5m"},
                                             {"--budget", "5m", "--steps", "5"},
                                             {"--budget", "0s"},
                                             {"--budget", "-5s"},
                                             {"--until", "06:00", "--steps", "5"},
                                             {"--until", "noon"},
                                             {"--until", "2020-01-01 06:00"},
                                             {"--grace", "7d"},
                                             {"--drop-raw", "--grace", "-7d"},
                                             {"--checkpoint-every", "-1s"}}) {
    const RunResult refused = run_engram(job(wrong));
    EXPECT_EQ(refused.exit_code, kWrongUsage) << wrong[0] << " " << wrong[1];
    EXPECT_NE(refused.err, "");
  }
  EXPECT_THAT(run_engram(job({"--until", "noon"})).err,
              AllOf(HasSubstr("--until"), HasSubstr("noon"), HasSubstr("06:00")));
  EXPECT_THAT(run_engram(job({"--yield-command", "/nowhere/busy"})).err,
              AllOf(HasSubstr("/nowhere/busy"), HasSubstr("cannot be run")));
}

TEST_F(NightJob, GoesOnAfterAKill) {
  const auto arguments = job({"--steps", "3000", "--checkpoint-every", "100ms"});
  RunResult killed;
  for (int i = 0; i < 10; ++i) {
    killed = run_engram_and_kill(arguments, 6000);
    ASSERT_EQ(killed.exit_code, -9) << killed.err;
    if (killed.err.find("training goes on from a checkpoint") != std::string::npos) break;
  }
  EXPECT_THAT(killed.err, HasSubstr("training goes on from a checkpoint"));
  const RunResult check = run_engram({"check", store_});
  EXPECT_EQ(check.exit_code, 0) << check.err;
  EXPECT_THAT(check.out, HasSubstr(".checkpoint"));
  const RunResult fresh = run_engram(job({"--steps", "5", "--fresh"}));
  EXPECT_EQ(fresh.exit_code, 0) << fresh.err;
  for (const auto& left :
       std::filesystem::directory_iterator(std::filesystem::path(store_) / "tmp"))
    EXPECT_EQ(left.path().extension(), ".history")
        << "what the night found out stays, not its work";
}

TEST_F(NightJob, ChoosesBetweenTheModelThatIsThereAndANewOne) {
  const auto night = [&](std::vector<std::string> more) {
    std::vector<std::string> all{"consolidate", store_, "--entity",  kCamera, "--steps", "5",
                                 "--nights",    "1",    "--threads", "1",     "--video", "av1"};
    all.insert(all.end(), more.begin(), more.end());
    const RunResult done = run_engram(all);
    EXPECT_EQ(done.exit_code, 0) << done.err;
    return done.out;
  };
  night({"--chain", "16"});
  EXPECT_THAT(night({"--force", "--anew", "--chain", "16"}),
              AllOf(HasSubstr("previous model"), HasSubstr("no new one was published")));
  const Json same =
      Json::parse(night({"--force", "--anew", "--chain", "16", "--json"})).at("entities").at(0);
  EXPECT_EQ(same.at("is_model_new"), false);
  EXPECT_EQ(same.at("model_version"), 1);
  EXPECT_EQ(same.at("choice").at("keeps_previous_model"), true);
  EXPECT_EQ(Json::parse(run_engram({"models", store_, "--json"}).out).at("models").size(), 1u);
  // Longer chains take fewer bytes.
  const Json other =
      Json::parse(night({"--force", "--chain", "40", "--json"})).at("entities").at(0);
  EXPECT_EQ(other.at("is_model_new"), true);
  EXPECT_EQ(other.at("started_from_version"), 1);
  const Json& choice = other.at("choice");
  EXPECT_LT(choice.at("new_model").at("total_bytes").get<double>(),
            choice.at("previous_model").at("total_bytes").get<double>());
  const Json models = Json::parse(run_engram({"models", store_, "--json"}).out).at("models");
  ASSERT_EQ(models.size(), 1u);
  EXPECT_EQ(models.at(0).at("started_from_version"), 1);
  EXPECT_EQ(models.at(0).at("choice"), choice);
  EXPECT_THAT(
      run_engram({"models", store_}).out,
      AllOf(HasSubstr("started from v1"), HasSubstr("previous model"), HasSubstr("new model")));
}

TEST_F(NightJob, WaitsForTheRobot) {
  const auto file = directory_.path() / "busy";
  std::ofstream(file) << "busy";
  const RunResult waiting =
      run_engram_and_kill(job({"--training", "1s", "--yield-file", file}), 60'000, "waiting: ");
  EXPECT_EQ(waiting.exit_code, -9);
  EXPECT_THAT(waiting.err, HasSubstr("busy exists"));
  std::filesystem::remove(file);
  const RunResult done = run_engram(job(
      {"--training", "1s", "--yield-file", file, "--yield-command", "test -e " + file.string()}));
  EXPECT_EQ(done.exit_code, 0) << done.err;
}

}  // namespace
}  // namespace engram::cli
