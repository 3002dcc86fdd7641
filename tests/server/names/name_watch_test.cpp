// SPDX-License-Identifier: Apache-2.0
// What watchers of a NameRegistry are told.
#include <algorithm>
#include <set>
#include <thread>

#include "tests/server/names/plain_registry.h"

namespace engram::server {
namespace {

using engram::testing::PlainRegistry;
using std::chrono::milliseconds;
using std::chrono::seconds;

std::vector<std::string> texts_of(const NameChanges& changes) {
  std::vector<std::string> texts;
  for (const NameEvent& event : changes.events)
    texts.push_back(event.server.server + " " + std::string(to_string(event.kind)));
  return texts;
}

TEST(NameWatch, BeginsWithEverything) {
  PlainRegistry registry;
  ASSERT_OK(registry->add(PlainRegistry::server("a", {"Vision"})));
  const auto changes = registry->changes_since({});
  EXPECT_TRUE(changes.is_everything);
  ASSERT_EQ(changes.servers.size(), 1u);
  EXPECT_EQ(changes.servers[0].server, "a");
  EXPECT_TRUE(changes.events.empty());
}

TEST(NameWatch, TellsWhatHappenedAndWhy) {
  PlainRegistry registry;
  const auto start = registry->changes_since({}).version;
  ASSERT_OK(registry->add(PlainRegistry::server("a", {"A"})));
  ASSERT_OK(registry->add(PlainRegistry::server("b", {"B"})));
  ASSERT_OK(registry->add(PlainRegistry::server("a", {"A"})));
  ASSERT_OK(registry->add(PlainRegistry::server("a", {"A", "C"})));
  ASSERT_OK(registry->add(PlainRegistry::server("a", {"A"}, 2)));
  ASSERT_OK(registry->remove("b", 1));
  registry.pass(seconds(4));
  const auto changes = registry->changes_since(start);
  EXPECT_FALSE(changes.is_everything);
  EXPECT_EQ(texts_of(changes),
            (std::vector<std::string>{"a arrived", "b arrived", "a changed", "a replaced",
                                      "a arrived", "b unregistered", "a lost heartbeat"}));
  EXPECT_EQ(changes.events[3].server.incarnation, 1u);
  EXPECT_EQ(changes.events[4].server.incarnation, 2u);
  EXPECT_TRUE(registry->changes_since(changes.version).events.empty());
}

TEST(NameWatch, GivesEverythingToWhoIsTooFarBehind) {
  PlainRegistry registry({.max_events = 3});
  const auto start = registry->changes_since({}).version;
  for (const char* name : {"a", "b", "c"})
    ASSERT_OK(registry->add(PlainRegistry::server(name, {name})));
  EXPECT_EQ(registry->changes_since(start).events.size(), 3u);
  ASSERT_OK(registry->remove("a", 1));
  const auto changes = registry->changes_since(start);
  EXPECT_TRUE(changes.is_everything);
  EXPECT_EQ(changes.servers.size(), 2u);
}

TEST(NameWatch, GivesEverythingToWhoWatchedTheOneBefore) {
  PlainRegistry before;
  ASSERT_OK(before->add(PlainRegistry::server("a", {"Vision"})));
  const auto version = before->changes_since({}).version;
  const auto after = std::move(*NameRegistry::create({}, PlainRegistry::kRegistry + 1));
  const auto changes = after->changes_since(version);
  EXPECT_TRUE(changes.is_everything);
  EXPECT_TRUE(changes.servers.empty());
  EXPECT_TRUE(after->changes_since({PlainRegistry::kRegistry + 1, 99}).is_everything)
      << "a version that never was";
}

TEST(NameWatch, WaitsForSomethingToHappen) {
  PlainRegistry registry;
  const auto start = registry->changes_since({}).version;
  EXPECT_TRUE(registry->wait_for_changes(start, steady_now() + milliseconds(1)).events.empty());
  std::jthread arriving([&] { EXPECT_OK(registry->add(PlainRegistry::server("a", {"A"}))); });
  EXPECT_EQ(texts_of(registry->wait_for_changes(start, steady_now() + seconds(60))),
            std::vector<std::string>{"a arrived"});
  const auto version = registry->changes_since(start).version;
  std::stop_source stop;
  stop.request_stop();
  EXPECT_EQ(
      registry->wait_for_changes(version, steady_now() + seconds(60), stop.get_token()).version,
      version);
}

TEST(NameWatch, ShowsTheSameToAWatcherAsToWhoAsks) {
  constexpr int kRounds = 300;
  PlainRegistry registry({.max_events = 50});
  std::set<std::string> seen;
  std::atomic<bool> is_done{false};
  {
    std::jthread watching([&] {
      NameVersion version;
      while (true) {
        const bool is_last = is_done;
        const auto changes = registry->wait_for_changes(version, steady_now() + milliseconds(1));
        if (changes.is_everything) {
          seen.clear();
          for (const Registration& server : changes.servers) seen.insert(server.server);
        }
        for (const NameEvent& event : changes.events) {
          if (event.kind == NameEventKind::kArrived)
            EXPECT_TRUE(seen.insert(event.server.server).second);
          else
            EXPECT_EQ(seen.erase(event.server.server), 1u);
        }
        version = changes.version;
        if (is_last) return;
      }
    });
    std::jthread([&] {
      for (int i = 0; i < kRounds; ++i) {
        const std::string name = "server " + std::to_string(i);
        EXPECT_OK(registry->add(PlainRegistry::server(name, {name})));
        if (i % 3 != 0) EXPECT_OK(registry->remove(name, 1));
      }
    }).join();
    is_done = true;
  }
  std::set<std::string> there;
  for (const Registration& server : registry->resolve(ltm::MemoryId())) there.insert(server.server);
  EXPECT_EQ(seen, there);
}

}  // namespace
}  // namespace engram::server
