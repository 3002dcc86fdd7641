// SPDX-License-Identifier: Apache-2.0
#include "server/robot/robot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <thread>

#include "ltm/recall/recall.h"
#include "server/client/memory_client.h"
#include "server/client/names_client.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::server {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

constexpr const char* kCam = "Vision/RGB/head/cam";

/// A robot at sockets in a folder of its own, on a machine that the test describes.
class RobotTest : public ::testing::Test {
 protected:
  void write(const std::filesystem::path& name, std::string_view text) const {
    std::filesystem::create_directories((folder_ / name).parent_path());
    overwrite_file(folder_ / name, std::as_bytes(std::span(text)));
  }

  /// RAM of the machine. Unit: MiB.
  void have_ram(uint64_t available) const {
    // Replaced at once: it is read meanwhile.
    write("host/proc/new",
          fmt::format("MemTotal: {} kB\nMemAvailable: {} kB\n", 1000 << 10, available << 10));
    std::filesystem::rename(folder_ / "host/proc/new", folder_ / "host/proc/meminfo");
  }

  [[nodiscard]] std::string at(const std::string& name) const {
    return "unix:" + (folder_ / name).string();
  }

  void start(const std::string& yaml) {
    const auto config = parse_robot_config(yaml, "robot.yaml", folder_.path());
    ASSERT_TRUE(config.ok()) << config.status().to_string();
    auto started =
        Robot::start(*config, {nullptr, folder_ / "host", "bench", std::chrono::milliseconds(20)});
    ASSERT_TRUE(started.ok()) << started.status().to_string();
    robot_ = *std::move(started);
  }

  /// The values that a query of a server finds.
  static std::vector<idf::Data> ask(const std::string& endpoint, const std::string& query) {
    const auto client = MemoryClient::connect(endpoint);
    EXPECT_TRUE(client.ok());
    const auto result = (*client)->query(*ltm::Query::parse(query));
    EXPECT_TRUE(result.ok()) << result.status().to_string();
    std::vector<idf::Data> values;
    if (!result.ok()) return values;
    for (const ltm::EntityResult* entity : result->entities())
      for (const ltm::SnapshotResult& snapshot : entity->snapshots)
        values.push_back(snapshot.instances[0].data);
    return values;
  }

  static ltm::Commit commit(const std::string& entity, int64_t time) {
    return {{{*ltm::MemoryId::parse(entity), time_from_ns(time), {{int64_t{7}, {}}}}}};
  }

  /// Asks until it holds, for a while.
  static bool eventually(const std::function<bool()>& holds) {
    for (int i = 0; i < 500; ++i) {
      if (holds()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return false;
  }

  void SetUp() override {
    write("host/proc/stat", "cpu  10 0 10 80 0 0 0 0 0 0\n");
    write("host/proc/self/status", "VmRSS: 1000 kB\n");
    have_ram(800);
  }

  ScratchDirectory folder_;
  std::unique_ptr<Robot> robot_;
};

TEST_F(RobotTest, KnowsItsPriorKnowledgeFromTheStart) {
  write("prior/Objects/Things/kitchen/cup.yaml", "height: 0.11\n");
  write("prior/prior.yaml", "time: 2024-05-01 00:00:00\n");
  const std::string yaml =
      "servers: [{store: a.engram, prior: prior, listen: '" + at("s") + "'}]\nsystem_state: false";
  for (int i = 0; i < 2; ++i) {
    start(yaml);
    // Once, however often it starts.
    const auto found = ask(at("s"), "Objects/Things/kitchen/cup @ all");
    ASSERT_THAT(found, SizeIs(1));
    EXPECT_EQ(found[0], idf::Data(idf::Dict{{"height", 0.11}}));
    const auto ended = robot_->stop();
    ASSERT_THAT(ended, SizeIs(1));
    EXPECT_TRUE(ended[0].status.ok());
    EXPECT_EQ(ended[0].counters.memory.committed, i == 0 ? 1u : 0u);
    robot_.reset();
  }
  // What was changed is committed anew.
  write("prior/Objects/Things/kitchen/cup.yaml", "height: 0.12\n");
  start(yaml);
  const auto found = ask(at("s"), "Objects/Things/kitchen/cup @ all");
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0], idf::Data(idf::Dict{{"height", 0.12}}));
}

TEST_F(RobotTest, SaysWhichPriorKnowledgeIsNotOfItsMemories) {
  write("prior/Objects/Things/kitchen/cup.yaml", "height: 0.11\n");
  const auto config =
      parse_robot_config("servers: [{memories: [Vision], prior: prior, listen: '" + at("s") + "'}]",
                         "robot.yaml", folder_.path());
  ASSERT_TRUE(config.ok());
  const auto started = Robot::start(*config);
  EXPECT_EQ(started.status().code(), StatusCode::kNotFound);
  EXPECT_THAT(started.status().message(), HasSubstr("has no memory 'Objects'"));
}

TEST_F(RobotTest, TellsHowTheMachineIs) {
  start("servers: [{store: a.engram, listen: '" + at("s") + "'}]");
  ASSERT_TRUE(eventually([this] {
    const auto client = MemoryClient::connect(at("s"));
    const auto result = (*client)->query(*ltm::Query::parse("SystemState/Host/bench/load @ all"));
    return result.ok() && result->snapshot_count() >= 2;
  }));
  const auto found = ask(at("s"), "SystemState/Host/bench/load");
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(*found[0].at("ram/total"), idf::Data(int64_t{1000} << 20));
  EXPECT_EQ(*found[0].at("working_memory_limit"), idf::Data(int64_t{512} << 20));
  EXPECT_EQ(*found[0].at("working_memory_reason"), idf::Data("as configured"));
}

TEST_F(RobotTest, MakesRoomWhereRamIsTight) {
  start("servers: [{store: a.engram, working_memory: {min_bytes: 1MiB}, listen: '" + at("s") +
        "'}]");
  const auto client = MemoryClient::connect(at("s"));
  const idf::Data large = idf::NdArray::take({1 << 20}, std::vector<uint8_t>(1 << 20));
  for (int i = 1; i <= 8; ++i) {
    ltm::Commit one = commit(kCam, i);
    one.updates[0].instances[0].data = large;
    ASSERT_TRUE((*client)->commit(one).ok());
  }
  have_ram(50);
  ASSERT_TRUE(eventually([this] {
    const auto found = ask(at("s"), "SystemState/Host/bench/load");
    return found.size() == 1 && *found[0].at("working_memory_reason") != idf::Data("as configured");
  }));
  EXPECT_TRUE(eventually([&] {
    const auto info = (*client)->info();
    return info.ok() && info->figures_json.find("\"memory_left\":0,") == std::string::npos;
  }));
  // What left is in the store.
  EXPECT_THAT(ask(at("s"), std::string(kCam) + " @ all"), SizeIs(8));
}

TEST_F(RobotTest, ServesSeveralAndSaysWhereTheyAre) {
  start(R"(
names: {listen: ')" +
        at("n") + R"('}
servers:
  - {name: vision, memories: [Vision], store: v.engram, listen: ')" +
        at("v") + R"('}
  - {name: grasp, memories: [Grasp], listen: '127.0.0.1:0'}
)");
  const auto names = NamesClient::connect(at("n"));
  ASSERT_TRUE(names.ok());
  const auto grasp = (*names)->resolve("Grasp");
  ASSERT_TRUE(grasp.ok()) << grasp.status().to_string();
  ASSERT_THAT(*grasp, SizeIs(1));
  EXPECT_EQ((*grasp)[0].server, "grasp");
  EXPECT_THAT((*grasp)[0].endpoints[0], ::testing::Not(HasSubstr(":0")));
  const auto client = MemoryClient::connect((*grasp)[0].endpoints[0]);
  ASSERT_TRUE((*client)->commit(commit("Grasp/a/b/c", 1)).ok());
  EXPECT_EQ((*client)->commit(commit(kCam, 1)).code(), StatusCode::kNotFound);
  // Longer than servers count as there without a word.
  std::this_thread::sleep_for(std::chrono::milliseconds(3500));
  const auto all = (*names)->resolve("");
  ASSERT_TRUE(all.ok());
  EXPECT_THAT(*all, SizeIs(2));
  const auto served = robot_->servers();
  ASSERT_THAT(served, SizeIs(2));
  EXPECT_EQ(served[0].store, folder_ / "v.engram");
  EXPECT_THAT(served[0].memories, ElementsAre("Vision", "SystemState"));
  EXPECT_THAT(robot_->names(), ElementsAre(at("n")));
}

TEST_F(RobotTest, RegistersWithANameSystemElsewhere) {
  start("names: {listen: '" + at("n") + "'}");
  const auto elsewhere = std::move(robot_);
  start("names: {at: '" + at("n") + "'}\nservers: [{name: a, memories: [A], listen: '" + at("s") +
        "'}]");
  const auto names = NamesClient::connect(at("n"));
  const auto found = (*names)->resolve("A", std::chrono::seconds(5));
  ASSERT_TRUE(found.ok()) << found.status().to_string();
  EXPECT_THAT(*found, SizeIs(1));
  robot_.reset();
  EXPECT_THAT(*(*names)->resolve("A"), SizeIs(0));
}

TEST_F(RobotTest, HandsEverythingToTheStoreWhenItStops) {
  start("system_state: false\nservers: [{store: a.engram, listen: '" + at("s") + "'}]");
  const auto client = MemoryClient::connect(at("s"));
  for (int i = 1; i <= 20; ++i) ASSERT_TRUE((*client)->commit(commit(kCam, i)).ok());
  const auto ended = robot_->stop();
  ASSERT_THAT(ended, SizeIs(1));
  EXPECT_TRUE(ended[0].status.ok()) << ended[0].status.to_string();
  EXPECT_EQ(ended[0].counters.memory.stored, 20u);
  EXPECT_EQ(ended[0].counters.memory.dropped, 0u);
  auto reader = ltm::StoreReader::open(folder_ / "a.engram");
  ASSERT_TRUE(reader.ok());
  EXPECT_EQ((*reader)->summary(*ltm::MemoryId::parse(kCam))->snapshots, 20u);
}

TEST_F(RobotTest, CountsWhatIsDroppedWithoutAStore) {
  start("system_state: false\nservers: [{listen: '" + at("s") + "'}]");
  const auto client = MemoryClient::connect(at("s"));
  for (int i = 1; i <= 3; ++i) ASSERT_TRUE((*client)->commit(commit(kCam, i)).ok());
  const auto ended = robot_->stop();
  EXPECT_TRUE(ended[0].status.ok());
  EXPECT_EQ(ended[0].counters.memory.committed, 3u);
  EXPECT_FALSE(ended[0].counters.store);
}

TEST_F(RobotTest, LeavesNothingRunningWhereAServerCannotStart) {
  const auto config =
      parse_robot_config("servers: [{name: a, store: a.engram, listen: '" + at("s") +
                             "'}, {name: b, store: a.engram, listen: '" + at("t") + "'}]",
                         "robot.yaml", folder_.path());
  ASSERT_TRUE(config.ok());
  const auto started = Robot::start(*config);
  EXPECT_EQ(started.status().code(), StatusCode::kFailedPrecondition);
  EXPECT_THAT(started.status().message(), HasSubstr("server 'b'"));
  start("servers: [{store: a.engram, listen: '" + at("s") + "'}]");
}

}  // namespace
}  // namespace engram::server
