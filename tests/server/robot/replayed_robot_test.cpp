// SPDX-License-Identifier: Apache-2.0
#include "server/robot/replayed_robot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "memory/replay_control.h"
#include "server/robot/robot.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::server {
namespace {

using ::testing::HasSubstr;

Time at_s(double seconds) {
  return time_from_ns(1'700'000'000'000'000'000 + static_cast<int64_t>(seconds * 1e9));
}

/// A robot with two servers and a name system, whose stores have something a second.
class ReplayedRobot : public ::testing::Test {
 protected:
  ReplayedRobot() {
    for (const char* name : {"Robot", "Vision"}) {
      memory::MemoryService::Options options;
      options.name = name;
      options.store.emplace().store = folder_ / (std::string(name) + ".engram");
      Time now = at_s(0);
      auto service = *memory::MemoryService::open(options, nullptr, [&now] { return now; });
      for (int i = 0; i < 10; ++i) {
        now = at_s(i);
        EXPECT_OK(service->commit(
            {{{*ltm::MemoryId::parse(std::string(name) + "/a/b/c"), now, {{int64_t{i}, {}}}}}}));
      }
      EXPECT_OK(service->close());
    }
  }

  void start(const std::string& yaml, const ReplayOptions& options) {
    auto config = parse_robot_config(yaml, "robot.yaml", folder_.path());
    ASSERT_OK(config);
    replay_ = replay_robot(*config, nullptr, options);
    if (!replay_.ok()) return;
    auto started = Robot::start(*config, {});
    ASSERT_OK(started);
    robot_ = *std::move(started);
  }

  [[nodiscard]] std::string at(const std::string& name) const {
    return "unix:" + (folder_ / name).string();
  }

  [[nodiscard]] std::string yaml() const {
    return "names: {listen: " + at("n") + "}\nservers:\n  - name: robot\n    listen: " + at("r") +
           "\n    memories: [Robot]\n    store: Robot.engram\n    durability: journal\n" +
           "  - name: vision\n    listen: " + at("v") +
           "\n    memories: [Vision]\n    store: Vision.engram\n";
  }

  static int64_t latest(Memory& memory, const std::string& query) {
    const auto answer = memory.query(query);
    if (!answer.ok()) return -1;
    return answer->entities().at(0)->snapshots.at(0).instances.at(0).data.get<int64_t>();
  }

  ScratchDirectory folder_;
  Result<std::shared_ptr<memory::Replay>> replay_ = not_found("not started");
  std::unique_ptr<Robot> robot_;
};

TEST_F(ReplayedRobot, HasAllItsServersOnOneClock) {
  start(yaml(), {.at = at_s(3), .is_paused = true});
  ASSERT_OK(replay_);
  const auto memory = Memory::connect(at("n"), {.is_name_system = true});
  ASSERT_OK(memory);
  EXPECT_EQ(latest(**memory, "Robot @ latest"), 3);
  EXPECT_EQ(latest(**memory, "Vision @ latest"), 3);
  ASSERT_OK(control_replay(**memory, {.kind = ReplayCommand::Kind::kSeek, .time = at_s(7.5)}));
  EXPECT_EQ(latest(**memory, "Robot @ latest"), 7);
  EXPECT_EQ(latest(**memory, "Vision @ latest"), 7);
  ASSERT_OK(control_replay(**memory, {.kind = ReplayCommand::Kind::kStep}));
  EXPECT_EQ(latest(**memory, "Robot @ latest"), 8);
  EXPECT_EQ(latest(**memory, "Vision @ latest"), 8);
  const auto state = replay_state(**memory);
  ASSERT_OK(state);
  EXPECT_EQ(state->stores.size(), 2u);
  EXPECT_EQ(state->now, at_s(8));
}

TEST_F(ReplayedRobot, TellsSubscribersOfAServerWhatComes) {
  start(yaml(), {.at = at_s(0), .is_paused = true});
  ASSERT_OK(replay_);
  const auto memory = Memory::connect(at("v"));
  ASSERT_OK(memory);
  Mutex mutex;
  ConditionVariable changed;
  std::vector<int64_t> told;
  const auto subscription =
      (*memory)->subscribe({.names = {"Vision"}, .with_data = true},
                           {[&](std::vector<ToldSnapshot> snapshots) {
                              const MutexLock lock(mutex);
                              for (const ToldSnapshot& one : snapshots)
                                told.push_back(one.snapshot.instances.at(0).data.get<int64_t>());
                              changed.notify_all();
                            },
                            {},
                            {}});
  ASSERT_OK(subscription);
  ASSERT_OK((*replay_)->obey({.kind = ReplayCommand::Kind::kSpeed, .speed = 100}));
  ASSERT_OK((*replay_)->obey({.kind = ReplayCommand::Kind::kPlay}));
  const MutexLock lock(mutex);
  changed.wait_for(mutex, std::chrono::seconds(20), [&] { return told.size() >= 9; });
  EXPECT_EQ(told, (std::vector<int64_t>{1, 2, 3, 4, 5, 6, 7, 8, 9}));
}

TEST_F(ReplayedRobot, TakesCommitsAndWritesNothing) {
  start(yaml(), {.at = at_s(3), .is_paused = true});
  ASSERT_OK(replay_);
  const auto memory = Memory::connect(at("r"));
  ASSERT_OK(memory);
  const ltm::MemoryId plan = *ltm::MemoryId::parse("Robot/a/b/plan");
  ASSERT_OK(
      (*memory)->commit({{{plan, system_now(), {{int64_t{42}, {}}}}}}, CommitDurability::kJournal));
  EXPECT_EQ(latest(**memory, "Robot/a/b/plan @ latest"), 42);
  for (const Robot::StoppedServer& ended : robot_->stop()) EXPECT_OK(ended.status);
  robot_.reset();
  const auto store = Memory::open(folder_ / "Robot.engram", {.is_read_only = true});
  ASSERT_OK(store);
  EXPECT_EQ((*store)->query("Robot/a/b/plan @ latest").status().code(), StatusCode::kNotFound);
}

TEST_F(ReplayedRobot, HasOneServerOfSystemState) {
  const auto owners = [this](const std::string& others) -> std::vector<std::string> {
    auto config = parse_robot_config(others, "robot.yaml", folder_.path());
    EXPECT_OK(config);
    const auto replay = replay_robot(*config, nullptr, {});
    if (!replay.ok()) return {std::string(replay.status().message())};
    std::vector<std::string> names;
    for (const ServerConfig& server : config->servers) {
      const auto& service = server.options.service;
      if (std::ranges::count(service.memories, "SystemState") > 0) names.push_back(service.name);
    }
    return names;
  };
  const auto robot = [this](const std::string& memories, const std::string& rest) {
    return "servers:\n  - name: state\n    listen: " + at("s") + "\n    memories: [" + memories +
           "]\n" + rest + "  - name: robot\n    listen: " + at("r") +
           "\n    memories: [Robot]\n    store: Robot.engram\n";
  };
  const std::string stored = "    store: Vision.engram\n";
  EXPECT_EQ(owners(robot("SystemState, Plans", stored)), std::vector<std::string>{"state"});
  EXPECT_EQ(owners(robot("SystemState, Plans", "")), std::vector<std::string>{"robot"});
  EXPECT_EQ(owners("system_state: false\n" + robot("Vision, SystemState", stored)),
            std::vector<std::string>{"state"});
  EXPECT_EQ(owners("system_state: false\n" + robot("Plans, SystemState", "")),
            std::vector<std::string>{"robot"});
  EXPECT_THAT(owners(robot("SystemState", "")).at(0),
              HasSubstr("server 'state' has the memory SystemState alone and no store"));
}

TEST_F(ReplayedRobot, KeepsTheBoundsAndTheRedactionOfItsStores) {
  auto config = parse_robot_config(yaml(), "robot.yaml", folder_.path());
  ASSERT_OK(config);
  memory::LongTerm::Options& store = *config->servers[1].options.service.store;
  store.max_answer_bytes = 12'345;
  store.recording.rules.push_back(
      {"cameras", *ltm::EntityPattern::parse("Vision"), {}, {}, {}, {}});
  ASSERT_OK(replay_robot(*config, nullptr, {}));
  const memory::MemoryService::Options& service = config->servers[1].options.service;
  EXPECT_EQ(service.max_answer_bytes, 12'345u);
  ASSERT_EQ(service.redacting.size(), 1u);
  EXPECT_EQ(service.redacting[0].name, "cameras");
}

TEST_F(ReplayedRobot, NeedsAStore) {
  start("servers: [{name: robot, listen: " + at("r") + "}]", {});
  EXPECT_EQ(replay_.status().code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(replay_.status().message()), HasSubstr("no server with a store"));
}

}  // namespace
}  // namespace engram::server
