// SPDX-License-Identifier: Apache-2.0
#include "server/client/robot_memory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "tests/ltm/expect_status.h"
#include "tests/server/client/small_robot.h"

namespace engram::server {
namespace {

using std::chrono::milliseconds;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;
using testing::SmallRobot;

/// A robot with the memories A and B.
class RobotMemoryTest : public ::testing::Test {
 protected:
  void SetUp() override {
    robot.start("A");
    robot.start("B");
    client = robot.client();
    ASSERT_OK(client->wait_for_memory("A", std::chrono::seconds(5)));
    ASSERT_OK(client->wait_for_memory("B", std::chrono::seconds(5)));
  }

  Result<std::vector<std::string>> ask(const std::string& query) {
    return SmallRobot::ask(*client, query);
  }

  SmallRobot robot;
  std::unique_ptr<RobotMemory> client;
};

TEST_F(RobotMemoryTest, SplitsCommitsAndUnitesAnswers) {
  std::vector<ServerOutcome> outcomes;
  ASSERT_OK(client->commit(SmallRobot::commit({"A/b/c/d", "B/b/c/d", "A/b/c/e"}, 1),
                           CommitDurability::kJournal, &outcomes));
  EXPECT_THAT(outcomes, SizeIs(2));
  EXPECT_THAT(*ask(".* @ all"), ElementsAre("A/b/c/d@1", "A/b/c/e@1", "B/b/c/d@1"));
  EXPECT_THAT(*ask("B @ all"), ElementsAre("B/b/c/d@1"));
  EXPECT_THAT(*ask("A/b/c/e ; B"), ElementsAre("A/b/c/e@1", "B/b/c/d@1"));
}

/// A thing in A, which moves along x; a camera that sees the first three steps of it, and an action
/// of the last two, in B.
ltm::Commit thing_and_camera(int64_t step) {
  const auto pose = [](double x, double z) {
    return idf::Data(idf::Dict{{"position", idf::NdArray::take<double>({3}, {x, 0, z})},
                               {"orientation", idf::NdArray::take<double>({4}, {1, 0, 0, 0})}});
  };
  const Time time = time_from_ns(step);
  const auto id = [](const char* text) { return *ltm::MemoryId::parse(text); };
  ltm::Commit commit;
  commit.updates.push_back(
      {id("A/b/c/thing"),
       time,
       {{idf::Dict{{"pose_world_thing", pose(0.1 * static_cast<double>(step), 1)},
                   {"is_visible", step != 2}},
         {}}}});
  commit.updates.push_back(
      {id("B/b/c/camera"),
       time,
       {{idf::Dict{{"pose_world_camera", pose(0, 0)}, {"calibration", "B/b/c/lens"}}, {}}}});
  if (step == 0)
    commit.updates.push_back({id("B/b/c/lens"),
                              time,
                              {{idf::Dict{{"fx", 100.0},
                                          {"fy", 100.0},
                                          {"cx", 4.0},
                                          {"cy", 4.0},
                                          {"width", 25},
                                          {"height", 9}},
                                {}}}});
  if (step == 3)
    commit.updates.push_back({id("B/b/c/push"),
                              time,
                              {{idf::Dict{{"started", step},
                                          {"ended", step + 1},
                                          {"what", id("A/b/c/thing").at(time).to_string()}},
                                {}}}});
  return commit;
}

TEST_F(RobotMemoryTest, AnswersConditionsOnWhatOtherServersHave) {
  for (int64_t step = 0; step < 5; ++step)
    ASSERT_OK(client->commit(thing_and_camera(step), CommitDurability::kMemory));
  EXPECT_THAT(*ask("A/b/c/thing @ all in-view B/b/c/camera"),
              ElementsAre("A/b/c/thing@0", "A/b/c/thing@1", "A/b/c/thing@2"));
  EXPECT_THAT(*ask("A/b/c/thing @ latest seen-with B/b/c/camera"), ElementsAre("A/b/c/thing@1"));
  EXPECT_THAT(*ask("B/b/c/camera @ all in-vain A/b/c/thing"), ElementsAre("B/b/c/camera@2"));
  EXPECT_THAT(*ask("A/b/c/thing @ all while B/b/c/push"),
              ElementsAre("A/b/c/thing@3", "A/b/c/thing@4"));
  EXPECT_THAT(*ask("A/b/c/thing @ all links-from B/b/c/push"), ElementsAre("A/b/c/thing@3"));
  // Of both servers, each of which needs what the other one has.
  EXPECT_THAT(*ask(".*/b/c/thing|camera @ all within A/b/c/thing 2m while B/b/c/push"),
              ElementsAre("A/b/c/thing@3", "A/b/c/thing@4", "B/b/c/camera@3", "B/b/c/camera@4"));
  size_t parts = 0;
  ASSERT_OK(client->query_parts(*ltm::Query::parse("A/b/c/thing @ all while B/b/c/push"),
                                [&parts](ltm::QueryResult part) {
                                  parts += part.snapshot_count();
                                  return Status();
                                }));
  EXPECT_EQ(parts, 2u);
  EXPECT_FAILS(ask("A/b/c/thing @ all while B/b/c/nobody").status(), StatusCode::kNotFound,
               "B/b/c/nobody");
  EXPECT_FAILS(ask("A/b/c/thing @ all while Nobody/b/c/d").status(), StatusCode::kNotFound,
               "Nobody/b/c/d");
}

TEST_F(RobotMemoryTest, SaysWhatNobodyHas) {
  ASSERT_OK(client->commit(SmallRobot::commit({"A/b/c/d"}, 1)));
  EXPECT_THAT(*ask(".*/.*/.*/d"), ElementsAre("A/b/c/d@1")) << "B has none";
  EXPECT_FAILS(ask("C @ all").status(), StatusCode::kNotFound, "C");
  EXPECT_FAILS(ask(".*/x/y/z").status(), StatusCode::kNotFound, "A-server");
}

TEST_F(RobotMemoryTest, ReportsEachPartOfACommit) {
  robot.options.timeout = milliseconds(600);
  client = robot.client();
  std::vector<ServerOutcome> outcomes;
  const Status status = client->commit(SmallRobot::commit({"A/b/c/d", "Nobody/b/c/d"}, 3),
                                       CommitDurability::kMemory, &outcomes);
  EXPECT_FAILS(status, StatusCode::kNotFound, "no server has memory 'Nobody'");
  ASSERT_THAT(outcomes, SizeIs(2));
  EXPECT_EQ(outcomes[0].server, "A-server");
  EXPECT_OK(outcomes[0].status);
  EXPECT_THAT(*ask("A @ all"), ElementsAre("A/b/c/d@3"));
}

TEST_F(RobotMemoryTest, RefusesWhatIsNoCommit) {
  EXPECT_EQ(client->commit({{{*ltm::MemoryId::parse("A/b"), Time(), {}}}}).code(),
            StatusCode::kInvalidArgument);
}

TEST_F(RobotMemoryTest, FindsServersThatMoved) {
  ASSERT_OK(client->commit(SmallRobot::commit({"A/b/c/d"}, 1)));
  robot.stop("A");
  robot.start("A", "elsewhere");
  ASSERT_OK(client->commit(SmallRobot::commit({"A/b/c/d", "B/b/c/d"}, 2)));
  EXPECT_THAT(*ask("A @ all"), ElementsAre("A/b/c/d@1", "A/b/c/d@2"));
}

TEST_F(RobotMemoryTest, WaitsForServersThatAreGone) {
  ASSERT_OK(client->commit(SmallRobot::commit({"A/b/c/d"}, 1), CommitDurability::kJournal));
  robot.stop("A");
  std::jthread later([this] {
    std::this_thread::sleep_for(milliseconds(700));
    robot.start("A", "later");
  });
  ASSERT_OK(client->commit(SmallRobot::commit({"A/b/c/d"}, 2)));
  EXPECT_THAT(*ask("A @ all"), ElementsAre("A/b/c/d@1", "A/b/c/d@2"));
}

TEST_F(RobotMemoryTest, QueriesWaitForServersThatAreGone) {
  ASSERT_OK(client->commit(SmallRobot::commit({"A/b/c/d"}, 1), CommitDurability::kJournal));
  ASSERT_THAT(*ask("A @ all"), SizeIs(1));
  robot.stop("A");
  std::jthread later([this] {
    std::this_thread::sleep_for(milliseconds(700));
    robot.start("A", "later");
  });
  EXPECT_THAT(*ask("A @ all"), ElementsAre("A/b/c/d@1"));
}

TEST_F(RobotMemoryTest, NamesServersThatCannotBeReached) {
  ASSERT_OK(client->commit(SmallRobot::commit({"A/b/c/d", "B/b/c/d"}, 1)));
  robot.options.timeout = milliseconds(600);
  client = robot.client();
  ASSERT_THAT(*ask(".* @ all"), SizeIs(2));
  // It is registered, and is not there.
  robot.stop("B");
  const auto names = robot.names.client();
  const Registrar lie(*names, {"B-server", {"B"}, {robot.endpoint("B")}, UINT64_MAX});
  ASSERT_FALSE(client->wait_for_memory("B", milliseconds(300)).ok());
  EXPECT_FAILS(ask(".* @ all").status(), StatusCode::kUnavailable, "B-server");
  EXPECT_FAILS(client->commit(SmallRobot::commit({"A/b/c/d", "B/b/c/d"}, 2)),
               StatusCode::kUnavailable, "B-server");
  const auto partial = client->query_reachable(*ltm::Query::parse(".* @ all"));
  ASSERT_OK(partial);
  EXPECT_THAT(partial->missing, SizeIs(1));
  EXPECT_EQ(partial->missing[0].server, "B-server");
  EXPECT_TRUE(partial->result.contains(*ltm::MemoryId::parse("A/b/c/d")));
  EXPECT_FAILS(client->query_reachable(*ltm::Query::parse("B @ all")), StatusCode::kUnavailable,
               "B-server");
}

TEST_F(RobotMemoryTest, AnswersInParts) {
  for (int64_t at = 1; at <= 3000; ++at)
    ASSERT_OK(client->commit(SmallRobot::commit({"A/b/c/d", "B/b/c/d", "B/b/c/e"}, at)));
  size_t parts = 0;
  ltm::QueryResult united(false);
  const auto query = *ltm::Query::parse(".* @ all");
  ASSERT_OK(client->query_parts(query, [&](ltm::QueryResult part) {
    ++parts;
    return united.merge(std::move(part));
  }));
  EXPECT_GE(parts, 2U) << "each server begins its own";
  EXPECT_EQ(united.snapshot_count(), 9000U);
  EXPECT_EQ(united.ids(), (*client->query(query)).ids());
  EXPECT_EQ(client
                ->query_parts(*ltm::Query::parse("A/b/c/none @ all"),
                              [](const auto&) { return Status(); })
                .code(),
            StatusCode::kNotFound);
}

TEST_F(RobotMemoryTest, EndsAnswersInPartsWithTheFirstError) {
  ASSERT_OK(client->commit(SmallRobot::commit({"A/b/c/d", "B/b/c/d"}, 1)));
  size_t parts = 0;
  const Status stopped = client->query_parts(*ltm::Query::parse(".* @ all"), [&](const auto&) {
    ++parts;
    return unavailable("the disk is full");
  });
  EXPECT_EQ(stopped.code(), StatusCode::kUnavailable);
  EXPECT_THAT(stopped.message(), HasSubstr("the disk is full"));
  EXPECT_EQ(parts, 1U) << "nothing is visited twice";
  // A server that is lost before its first part is waited for, and named.
  robot.options.timeout = milliseconds(600);
  client = robot.client();
  robot.stop("B");
  const auto names = robot.names.client();
  const Registrar lie(*names, {"B-server", {"B"}, {robot.endpoint("B")}, UINT64_MAX});
  ASSERT_FALSE(client->wait_for_memory("B", milliseconds(300)).ok());
  EXPECT_FAILS(
      client->query_parts(*ltm::Query::parse(".* @ all"), [](const auto&) { return Status(); }),
      StatusCode::kUnavailable, "B-server");
}

TEST_F(RobotMemoryTest, IsNotFooledByAnotherServerAtThatEndpoint) {
  robot.options.timeout = milliseconds(600);
  client = robot.client();
  const auto names = robot.names.client();
  const Registrar lie(*names, {"C-server", {"C"}, {robot.endpoint("A")}, 1});
  EXPECT_FAILS(client->wait_for_memory("C", milliseconds(500)), StatusCode::kUnavailable,
               "cannot be reached from this host");
}

TEST_F(RobotMemoryTest, GoesOnWithoutTheNameSystem) {
  ASSERT_OK(client->commit(SmallRobot::commit({"A/b/c/d", "B/b/c/d"}, 1)));
  robot.names.stop();
  ASSERT_OK(client->commit(SmallRobot::commit({"A/b/c/d", "B/b/c/d"}, 2)));
  EXPECT_THAT(*ask(".* @ latest"), ElementsAre("A/b/c/d@2", "B/b/c/d@2"));
}

TEST_F(RobotMemoryTest, ServersRegisterAgainWhenTheNameSystemStartsOver) {
  robot.names.stop();
  robot.names.start();
  const auto newcomer = robot.client();
  ASSERT_OK(newcomer->wait_for_memory("A", std::chrono::seconds(4)));
  ASSERT_OK(newcomer->wait_for_memory("B", std::chrono::seconds(4)));
  ASSERT_OK(newcomer->commit(SmallRobot::commit({"A/b/c/d", "B/b/c/d"}, 2)));
}

TEST_F(RobotMemoryTest, NewcomersWaitForTheNameSystem) {
  ASSERT_OK(client->commit(SmallRobot::commit({"A/b/c/d"}, 1)));
  robot.names.stop();
  std::jthread later([this] {
    std::this_thread::sleep_for(milliseconds(500));
    robot.names.start();
  });
  const auto newcomer = robot.client();
  // Of all memories those count that have registered again, which may be B alone.
  EXPECT_OK(SmallRobot::ask(*newcomer, "A @ all"));
}

TEST_F(RobotMemoryTest, SeesServersThatArrive) {
  ASSERT_OK(client->commit(SmallRobot::commit({"A/b/c/d"}, 1)));
  ASSERT_THAT(*ask(".* @ all"), SizeIs(1));
  robot.start("C");
  ASSERT_OK(client->wait_for_memory("C", std::chrono::seconds(5)));
  ASSERT_OK(client->commit(SmallRobot::commit({"C/b/c/d"}, 1)));
  EXPECT_THAT(*ask(".* @ all"), ElementsAre("A/b/c/d@1", "C/b/c/d@1"));
}

TEST_F(RobotMemoryTest, SaysWhatAllServersSay) {
  const auto all = client->info();
  ASSERT_OK(all);
  ASSERT_THAT(*all, SizeIs(2));
  for (const RobotServer& one : *all) {
    ASSERT_OK(one.info);
    EXPECT_EQ(one.info->server, one.registration.server);
  }
}

TEST_F(RobotMemoryTest, DeclaresWhereTheMemoryIs) {
  ASSERT_OK(client->declare(*ltm::MemoryId::parse("B/typed"), idf::Type::int64()));
  const Status refused = client->commit(
      {{{*ltm::MemoryId::parse("B/typed/c/d"), time_from_ns(1), {{std::string("text"), {}}}}}});
  EXPECT_EQ(refused.code(), StatusCode::kInvalidArgument);
  ASSERT_OK(client->commit(SmallRobot::commit({"B/typed/c/d"}, 1)));
}

TEST_F(RobotMemoryTest, ServesManyThreadsWhileServersStartOver) {
  constexpr int kThreads = 4;
  constexpr int64_t kEach = 60;
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < kThreads; ++t)
      threads.emplace_back([this, t] {
        const std::string below = fmt::format("/b/c/d{}", t);
        for (int64_t at = 1; at <= kEach; ++at)
          ASSERT_OK(client->commit(SmallRobot::commit({"A" + below, "B" + below}, at),
                                   CommitDurability::kJournal));
      });
    for (int round = 0; round < 3; ++round) {
      std::this_thread::sleep_for(milliseconds(150));
      robot.stop(round % 2 == 0 ? "A" : "B");
      robot.start(round % 2 == 0 ? "A" : "B", fmt::format("s{}", round));
    }
  }
  EXPECT_THAT(*ask(".* @ all"), SizeIs(size_t{2} * kThreads * kEach));
}

TEST(RobotMemory, SaysThatItCannotReachTheNameSystem) {
  ClientOptions options;
  options.timeout = milliseconds(300);
  const auto client = RobotMemory::connect("unix:/nowhere/names", options);
  ASSERT_OK(client);
  EXPECT_FAILS(SmallRobot::ask(**client, ".* @ all"), StatusCode::kUnavailable, "name system");
  EXPECT_FALSE((*client)->info().ok());
  EXPECT_FAILS((*client)->commit(SmallRobot::commit({"A/b/c/d"}, 1)), StatusCode::kUnavailable,
               "name system");
  // Nor does it say that nobody has a memory: that it cannot know.
  EXPECT_FAILS((*client)->declare(*ltm::MemoryId::parse("A/b"), idf::Type::int64()),
               StatusCode::kUnavailable, "name system");
  EXPECT_FALSE(RobotMemory::connect("no endpoint", options).ok());
}

}  // namespace
}  // namespace engram::server
