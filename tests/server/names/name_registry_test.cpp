// SPDX-License-Identifier: Apache-2.0
#include "server/names/name_registry.h"

#include <algorithm>
#include <thread>

#include "tests/server/names/plain_registry.h"

namespace engram::server {
namespace {

using engram::testing::PlainRegistry;
using std::chrono::milliseconds;
using std::chrono::seconds;

std::vector<std::string> names_of(const std::vector<Registration>& servers) {
  std::vector<std::string> names;
  for (const Registration& server : servers) names.push_back(server.server);
  return names;
}

TEST(NameRegistry, FindsTheServerOfAMemory) {
  PlainRegistry registry;
  const auto vision = PlainRegistry::server("a", {"Vision", "Sound"});
  const auto lease = registry->add(vision);
  ASSERT_OK(lease);
  EXPECT_EQ(lease->heartbeat_interval, seconds(1));
  EXPECT_EQ(lease->expires_after, seconds(3));
  EXPECT_EQ(*registry->find("Sound"), vision);
  EXPECT_FAILS(registry->find("Grasp"), StatusCode::kNotFound, "memory 'Grasp'");
}

TEST(NameRegistry, ResolvesIdsAndPatterns) {
  using Names = std::vector<std::string>;
  PlainRegistry registry;
  ASSERT_OK(registry->add(PlainRegistry::server("b", {"Vision", "Sound"})));
  ASSERT_OK(registry->add(PlainRegistry::server("a", {"Robot"})));
  ASSERT_OK(registry->add(PlainRegistry::server("c", {})));
  const auto of_id = [&](std::string_view id) {
    return names_of(registry->resolve(*ltm::MemoryId::parse(id)));
  };
  const auto of_pattern = [&](std::string_view text) {
    return names_of(registry->resolve(*ltm::NamePattern::parse(text)));
  };
  EXPECT_EQ(of_id("Vision/RGB/head/cam/2022-02-18 13:06:56.492182/0"), Names{"b"});
  EXPECT_EQ(of_id("Robot"), Names{"a"});
  EXPECT_EQ(of_id("Grasp"), Names{});
  EXPECT_EQ(of_id(""), (Names{"a", "b", "c"}));
  EXPECT_EQ(of_pattern(".*"), (Names{"a", "b"}));
  EXPECT_EQ(of_pattern("(Vision|Sound)"), Names{"b"});
  EXPECT_EQ(of_pattern("Vis"), Names{});
}

TEST(NameRegistry, RefusesASecondServerForAMemoryAndNamesTheFirst) {
  PlainRegistry registry;
  ASSERT_OK(registry->add(PlainRegistry::server("a", {"Vision"})));
  const auto second = PlainRegistry::server("b", {"Robot", "Vision"});
  EXPECT_FAILS(registry->add(second), StatusCode::kAlreadyExists,
               "memory 'Vision': server 'a' at 'unix:/run/a.sock' holds it");
  EXPECT_EQ(registry.holder("Robot"), "") << "a refused registration must change nothing";
  EXPECT_FAILS(registry->heartbeat("b", 1), StatusCode::kNotFound, "'b'");
}

TEST(NameRegistry, KeepsAServerWhileItsHeartbeatsCome) {
  PlainRegistry registry;
  ASSERT_OK(registry->add(PlainRegistry::server("a", {"Vision"})));
  for (int i = 0; i < 10; ++i) {
    registry.pass(seconds(3));
    ASSERT_OK(registry->heartbeat("a", 1));
  }
  EXPECT_EQ(registry.holder("Vision"), "a");
}

TEST(NameRegistry, LetsGoOfAServerThatMissedThreeHeartbeats) {
  PlainRegistry registry;
  ASSERT_OK(registry->add(PlainRegistry::server("a", {"Vision"})));
  ASSERT_OK(registry->add(PlainRegistry::server("b", {"Robot"})));
  registry.pass(seconds(2));
  ASSERT_OK(registry->heartbeat("b", 1));
  registry.pass(seconds(1));
  EXPECT_EQ(registry->expire(), 0u);
  registry.pass(milliseconds(1));
  EXPECT_EQ(registry->expire(), 1u);
  EXPECT_EQ(registry.holder("Vision"), "");
  EXPECT_EQ(registry.holder("Robot"), "b");
  EXPECT_FAILS(registry->heartbeat("a", 1), StatusCode::kNotFound, "register again");
}

TEST(NameRegistry, GivesTheMemoryOfAServerThatIsGoneToAnother) {
  PlainRegistry registry;
  ASSERT_OK(registry->add(PlainRegistry::server("a", {"Vision"})));
  registry.pass(seconds(4));
  ASSERT_OK(registry->add(PlainRegistry::server("b", {"Vision"})));
  EXPECT_EQ(registry.holder("Vision"), "b");
  EXPECT_FAILS(registry->add(PlainRegistry::server("a", {"Vision"})), StatusCode::kAlreadyExists,
               "server 'b'");
}

TEST(NameRegistry, LetsANewerIncarnationReplaceAnOlderOneAtOnce) {
  PlainRegistry registry;
  ASSERT_OK(registry->add(PlainRegistry::server("a", {"Vision", "Sound"}, 5)));
  ASSERT_OK(registry->add(PlainRegistry::server("a", {"Vision"}, 6)));
  EXPECT_EQ(registry->find("Vision")->incarnation, 6u);
  EXPECT_EQ(registry.holder("Sound"), "");
  EXPECT_FAILS(registry->heartbeat("a", 5), StatusCode::kFailedPrecondition, "incarnation 6");
  EXPECT_FAILS(registry->remove("a", 5), StatusCode::kFailedPrecondition, "incarnation 6");
  EXPECT_FAILS(registry->add(PlainRegistry::server("a", {"Vision"}, 5)),
               StatusCode::kFailedPrecondition, "older one 5");
  EXPECT_OK(registry->heartbeat("a", 6));
}

TEST(NameRegistry, TakesMoreMemoriesOfAServerThatIsIn) {
  PlainRegistry registry;
  ASSERT_OK(registry->add(PlainRegistry::server("a", {"Vision"})));
  ASSERT_OK(registry->add(PlainRegistry::server("b", {"Robot"})));
  ASSERT_OK(registry->add(PlainRegistry::server("a", {"Sound", "Vision"})));
  EXPECT_EQ(registry.holder("Sound"), "a");
  EXPECT_FALSE(registry->add(PlainRegistry::server("a", {"Robot"})).ok());
  EXPECT_EQ(registry.holder("Sound"), "a");
  ASSERT_OK(registry->add(PlainRegistry::server("a", {})));
  EXPECT_EQ(registry.holder("Sound"), "");
}

TEST(NameRegistry, ForgetsAServerThatLeaves) {
  PlainRegistry registry;
  ASSERT_OK(registry->add(PlainRegistry::server("a", {"Vision"})));
  EXPECT_OK(registry->remove("a", 1));
  EXPECT_EQ(registry.holder("Vision"), "");
  EXPECT_FAILS(registry->remove("a", 1), StatusCode::kNotFound, "'a'");
}

TEST(NameRegistry, IsBounded) {
  PlainRegistry registry({.max_servers = 2});
  ASSERT_OK(registry->add(PlainRegistry::server("a", {"A"})));
  ASSERT_OK(registry->add(PlainRegistry::server("b", {"B"})));
  EXPECT_FAILS(registry->add(PlainRegistry::server("c", {"C"})), StatusCode::kResourceExhausted,
               "at most 2");
  EXPECT_OK(registry->add(PlainRegistry::server("a", {"A", "C"})));
  registry.pass(seconds(4));
  EXPECT_OK(registry->add(PlainRegistry::server("c", {"C"})));
}

TEST(NameRegistry, RefusesOptionsThatMakeNoSense) {
  const auto refuses = [](const NameRegistry::Options& options) {
    return !NameRegistry::create(options, 1).ok();
  };
  EXPECT_TRUE(refuses({.heartbeat_interval = Duration(0)}));
  EXPECT_TRUE(refuses({.heartbeat_interval = std::chrono::hours(1'000'000)}));
  EXPECT_TRUE(refuses({.max_missed = 0}));
  EXPECT_TRUE(refuses({.max_servers = 0}));
  EXPECT_TRUE(refuses({.max_events = 0}));
  EXPECT_TRUE(refuses({.registration = {.text_bytes = 0}}));
}

TEST(NameRegistry, WakesWhoWaitsForAMemory) {
  PlainRegistry registry;
  std::jthread arriving([&] { EXPECT_OK(registry->add(PlainRegistry::server("a", {"Vision"}))); });
  const auto found = registry->wait_for("Vision", steady_now() + seconds(60));
  ASSERT_OK(found);
  EXPECT_EQ(found->server, "a");
}

TEST(NameRegistry, StopsWaitingAtTheDeadlineAndWhenAsked) {
  PlainRegistry registry;
  EXPECT_FAILS(registry->wait_for("Vision", steady_now() + milliseconds(1)),
               StatusCode::kUnavailable, "memory 'Vision'");
  std::stop_source stop;
  std::jthread stopping([&] { stop.request_stop(); });
  EXPECT_FAILS(registry->wait_for("Vision", steady_now() + seconds(60), stop.get_token()),
               StatusCode::kCancelled, "memory 'Vision'");
}

TEST(NameRegistry, GivesEachMemoryToOneOfManyThreads) {
  constexpr int kThreads = 4;
  constexpr int kRounds = 200;
  PlainRegistry registry;
  std::atomic<int> won{0};
  {
    std::vector<std::jthread> threads;
    for (int thread = 0; thread < kThreads; ++thread)
      threads.emplace_back([&, thread] {
        for (int round = 0; round < kRounds; ++round) {
          const std::string name = "server-" + std::to_string(thread);
          const auto memory = "Memory " + std::to_string(round);
          if (registry->add(PlainRegistry::server(name + memory, {memory})).ok()) ++won;
          registry->resolve(*ltm::NamePattern::parse("Memory 1.*"));
        }
      });
  }
  EXPECT_EQ(won, kRounds);
  EXPECT_EQ(registry->resolve(ltm::MemoryId()).size(), static_cast<size_t>(kRounds));
}

}  // namespace
}  // namespace engram::server
