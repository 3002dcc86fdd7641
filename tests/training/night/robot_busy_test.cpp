// SPDX-License-Identifier: Apache-2.0
#include "training/night/robot_busy.h"

#include <gtest/gtest.h>

#include <fstream>
#include <thread>

#include "tests/training/moving_scene.h"
#include "training/fit/job_pace.h"

namespace engram::training {
namespace {

using engram::testing::ScratchPath;
using std::chrono::milliseconds;

void touch(const std::filesystem::path& path) {
  std::ofstream(path) << "busy";
}

std::unique_ptr<RobotBusy> busy_by(const RobotBusy::Options& options) {
  auto busy = RobotBusy::create(options);
  EXPECT_TRUE(busy.ok()) << busy.status().to_string();
  return std::move(busy).value();
}

TEST(RobotBusy, WhileAFileExists) {
  const ScratchPath file("busy_file");
  const auto busy = busy_by({.file = file.path(), .file_interval = Duration(0)});
  EXPECT_EQ(busy->reason(), std::nullopt);
  touch(file.path());
  EXPECT_EQ(busy->reason(), file.path().string() + " exists");
  std::filesystem::remove(file.path());
  EXPECT_EQ(busy->reason(), std::nullopt);
}

TEST(RobotBusy, WhileACommandEndsWithZero) {
  const ScratchPath file("busy_command");
  const std::string command = "test  -e " + file.path().string();
  const auto busy = busy_by({.command = command, .command_interval = milliseconds(400)});
  EXPECT_EQ(busy->reason(), std::nullopt);
  touch(file.path());
  for (int i = 0; i < 1000 && !busy->reason(); ++i) std::this_thread::sleep_for(milliseconds(10));
  EXPECT_EQ(busy->reason(), "'" + command + "' says so");
}

TEST(RobotBusy, ReadsCommandsWithoutAShell) {
  EXPECT_TRUE(busy_by({.command = "test a = a"})->reason().has_value());
  // A shell would end both with 0.
  EXPECT_FALSE(busy_by({.command = "test -z $NO_SUCH_VARIABLE"})->reason().has_value());
  EXPECT_FALSE(busy_by({.command = "test a = b;true"})->reason().has_value());
  for (const char* command : {"/nowhere/at/all", "  "}) {
    const auto busy = RobotBusy::create({.command = command});
    EXPECT_EQ(busy.status().code(), StatusCode::kInvalidArgument) << command;
  }
}

TEST(RobotBusy, DoesNotWaitForACommandThatHangs) {
  const auto start = std::chrono::steady_clock::now();
  const auto busy = busy_by({.command = "sleep 600", .command_interval = milliseconds(100)});
  EXPECT_EQ(busy->reason(), std::nullopt);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(60));
}

TEST(JobPace, WaitsAndTellsWhy) {
  const ScratchPath file("pace");
  touch(file.path());
  const auto busy = busy_by({.file = file.path()});
  std::vector<std::string> details;
  const ProgressSink progress = [&](const Progress& now) {
    EXPECT_EQ(now.what, "train x");
    details.push_back(now.detail);
    if (details.size() > 2) std::filesystem::remove(file.path());
  };
  const std::stop_token stop;
  JobPace pace(busy.get(), progress, stop);
  pace.progress()({"train x", 1, 2, "epoch 1", 3});
  EXPECT_TRUE(pace.is_busy());
  ASSERT_TRUE(pace.pause().ok());
  EXPECT_FALSE(pace.is_busy());
  ASSERT_GE(details.size(), 3u);
  EXPECT_EQ(details[0], "epoch 1");
  EXPECT_EQ(details[1], "waiting: " + file.path().string() + " exists");
  EXPECT_GT(pace.paused_seconds(), 0.05);
}

TEST(JobPace, StopsWaitingOnAStopAndAtTheEnd) {
  const ScratchPath file("pace_end");
  touch(file.path());
  const auto busy = busy_by({.file = file.path()});
  const ProgressSink no_progress;
  Time now = time_from_ns(0);
  const std::stop_token no_stop;
  JobPace ending(busy.get(), no_progress, no_stop, now + std::chrono::minutes(1),
                 [&now] { return now += std::chrono::seconds(25); });
  EXPECT_EQ(ending.pause().code(), StatusCode::kResourceExhausted);
  EXPECT_TRUE(ending.is_time_over());
  std::stop_source source;
  const std::stop_token stop = source.get_token();
  JobPace stopped(busy.get(), no_progress, stop);
  std::jthread stopper([&] {
    std::this_thread::sleep_for(milliseconds(50));
    source.request_stop();
  });
  EXPECT_EQ(stopped.pause().code(), StatusCode::kCancelled);
}

}  // namespace
}  // namespace engram::training
