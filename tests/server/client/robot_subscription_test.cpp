// SPDX-License-Identifier: Apache-2.0
#include "server/client/robot_subscription.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <condition_variable>
#include <set>
#include <thread>

#include "tests/ltm/expect_status.h"
#include "tests/server/client/small_robot.h"

namespace engram::server {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::HasSubstr;
using testing::SmallRobot;

/// Remembers what it is told, and that one thread at a time tells it.
struct Told {
  std::mutex mutex;
  std::condition_variable changed;
  std::set<std::string> ids;
  std::vector<std::string> interruptions;
  std::atomic<int> inside{0};
  std::atomic<bool> is_parallel{false};

  SubscriptionHandlers handlers() {
    SubscriptionHandlers made;
    made.on_snapshots = [this](std::vector<ToldSnapshot> told) {
      if (++inside > 1) is_parallel = true;
      {
        const std::scoped_lock lock(mutex);
        for (const ToldSnapshot& one : told)
          ids.insert(
              fmt::format("{}@{}", one.snapshot.entity.to_string(), to_ns(one.snapshot.time)));
      }
      changed.notify_all();
      --inside;
    };
    made.on_interrupted = [this](const Status& status) {
      if (++inside > 1) is_parallel = true;
      {
        const std::scoped_lock lock(mutex);
        interruptions.push_back(status.message());
      }
      changed.notify_all();
      --inside;
    };
    return made;
  }

  bool wait_for(const std::string& id) {
    std::unique_lock lock(mutex);
    return changed.wait_for(lock, seconds(10), [&] { return ids.contains(id); });
  }
};

/// Commits later and later moments until one is told.
bool is_told_of(RobotMemory& client, const std::string& entity, Told& told) {
  for (int64_t at = 1000; at < 1100; ++at) {
    EXPECT_OK(client.commit(SmallRobot::commit({entity}, at)));
    std::unique_lock lock(told.mutex);
    const auto is_there = [&] {
      return std::ranges::any_of(told.ids, [&](const std::string& id) {
        return id.starts_with(entity + "@1") && id.size() > entity.size() + 4;
      });
    };
    if (told.changed.wait_for(lock, milliseconds(100), is_there)) return true;
  }
  return false;
}

TEST(RobotSubscription, TellsOfAllServers) {
  SmallRobot robot;
  robot.start("A");
  robot.start("B");
  const auto client = robot.client();
  ASSERT_OK(client->wait_for_memory("A", seconds(5)));
  ASSERT_OK(client->wait_for_memory("B", seconds(5)));
  Told told;
  const auto subscription = client->subscribe({}, told.handlers());
  ASSERT_OK(subscription);
  ASSERT_OK(client->commit(SmallRobot::commit({"A/b/c/d", "B/b/c/d"}, 1)));
  EXPECT_TRUE(told.wait_for("A/b/c/d@1"));
  EXPECT_TRUE(told.wait_for("B/b/c/d@1"));
  EXPECT_FALSE(told.is_parallel);
}

TEST(RobotSubscription, TellsOfServersThatArriveLater) {
  SmallRobot robot;
  const auto client = robot.client();
  Told told;
  const auto subscription = client->subscribe({.names = {"A/.*/.*/d"}}, told.handlers());
  ASSERT_OK(subscription);
  robot.start("A");
  ASSERT_OK(client->wait_for_memory("A", seconds(5)));
  EXPECT_TRUE(is_told_of(*client, "A/b/c/d", told));
}

TEST(RobotSubscription, TellsOfGapsAndGoesOnWhereAServerMoved) {
  SmallRobot robot;
  robot.start("A");
  const auto client = robot.client();
  ASSERT_OK(client->wait_for_memory("A", seconds(5)));
  Told told;
  const auto subscription = client->subscribe({}, told.handlers());
  ASSERT_OK(subscription);
  robot.stop("A");
  robot.start("A", "elsewhere");
  EXPECT_TRUE(is_told_of(*client, "A/b/c/d", told));
  const std::scoped_lock lock(told.mutex);
  ASSERT_FALSE(told.interruptions.empty());
  EXPECT_THAT(told.interruptions[0], HasSubstr("A-server"));
}

TEST(RobotSubscription, GoesOnWhenServerAndNameSystemStartOver) {
  SmallRobot robot;
  robot.start("A");
  const auto client = robot.client();
  ASSERT_OK(client->wait_for_memory("A", seconds(5)));
  Told told;
  const auto subscription = client->subscribe({}, told.handlers());
  ASSERT_OK(subscription);
  robot.names.stop();
  robot.stop("A");
  robot.names.start();
  robot.start("A");
  EXPECT_TRUE(is_told_of(*client, "A/b/c/d", told));
}

TEST(RobotSubscription, OutlivesItsClient) {
  SmallRobot robot;
  robot.start("A");
  auto client = robot.client();
  ASSERT_OK(client->wait_for_memory("A", seconds(5)));
  Told told;
  auto subscription = client->subscribe({}, told.handlers());
  ASSERT_OK(subscription);
  client = robot.client();
  ASSERT_OK(client->commit(SmallRobot::commit({"A/b/c/d"}, 1)));
  EXPECT_TRUE(told.wait_for("A/b/c/d@1"));
}

TEST(RobotSubscription, RefusesNamesThatAreNone) {
  SmallRobot robot;
  Told told;
  EXPECT_EQ(robot.client()->subscribe({.names = {"A/("}}, told.handlers()).status().code(),
            StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace engram::server
