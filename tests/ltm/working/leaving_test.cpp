// SPDX-License-Identifier: Apache-2.0
// What leaves working memory, in which order, and what becomes of it.
#include "tests/ltm/expect_status.h"
#include "tests/ltm/working/plain_memory.h"

namespace engram::ltm {
namespace {

using engram::testing::PlainMemory;
using std::chrono::seconds;

WorkingMemory::Options max_snapshots(size_t count) {
  WorkingMemory::Options options;
  options.all.snapshots = count;
  return options;
}

idf::Data bytes(size_t count) {
  return std::string(count, 'x');
}

TEST(Leaving, TakesTheOldestAndOnlyWhenItIsStored) {
  PlainMemory memory(max_snapshots(2));
  for (const int64_t at : {1, 2, 3, 4}) memory.commit("A/b/c/d", at);
  EXPECT_EQ(memory.times("A/b/c/d"), (std::vector<int64_t>{1, 2, 3, 4})) << "not stored yet";
  EXPECT_EQ(memory->counters().waiting, 2u);
  EXPECT_EQ(memory.store(), 2u);
  EXPECT_EQ(memory.times("A/b/c/d"), (std::vector<int64_t>{3, 4}));
  EXPECT_EQ(memory->counters().left, 2u);
  EXPECT_EQ(memory->counters().waiting_bytes, 0u);
}

TEST(Leaving, KeepsWhatTheSinkDidNotTake) {
  PlainMemory memory(max_snapshots(1));
  for (const int64_t at : {1, 2, 3}) memory.commit("A/b/c/d", at);
  const auto failed = memory->store([](auto) { return unavailable("the disk is full"); });
  EXPECT_EQ(failed.status().code(), StatusCode::kUnavailable);
  EXPECT_EQ(memory.times("A/b/c/d").size(), 3u);
  EXPECT_EQ(memory.store(1), 1u) << "one at least";
  EXPECT_EQ(memory.store(), 1u);
  EXPECT_EQ(memory.stored, (std::vector<std::string>{"A/b/c/d/1970-01-01 00:00:00.000000001",
                                                     "A/b/c/d/1970-01-01 00:00:00.000000002"}));
}

TEST(Leaving, RefusesCommitsWhereTooMuchWaits) {
  auto options = max_snapshots(1);
  options.max_waiting_bytes = 3000;
  PlainMemory memory(options);
  memory.commit("A/b/c/d", 1, bytes(4000));
  memory.commit("A/b/c/d", 2, bytes(4000));
  const Status refused = memory->commit({{PlainMemory::snapshot("A/b/c/d", 3, bytes(10))}});
  EXPECT_EQ(refused.code(), StatusCode::kResourceExhausted);
  EXPECT_EQ(memory.store(), 1u);
  memory.commit("A/b/c/d", 3, bytes(10));
  EXPECT_EQ(memory->counters().refused, 1u);
}

TEST(Leaving, TakesWhatIsNotReadFirst) {
  PlainMemory memory(max_snapshots(2));
  memory.commit("A/b/c/read", 1);
  memory.commit("A/b/c/unread", 1);
  memory.now += seconds(10);
  for (int i = 0; i < 5; ++i) memory.ask("A/b/c/read");
  memory.commit("A/b/c/new", 1);
  memory.store();
  EXPECT_EQ(memory.stored, std::vector<std::string>{"A/b/c/unread/1970-01-01 00:00:00.000000001"});
}

TEST(Leaving, ForgetsReadsOfLongAgo) {
  PlainMemory memory(max_snapshots(2));
  memory.commit("A/b/c/once", 1);
  for (int i = 0; i < 100; ++i) memory.ask("A/b/c/once");
  memory.now += seconds(3600);
  memory.commit("A/b/c/other", 1);
  memory.now += seconds(10);
  memory.commit("A/b/c/new", 1);
  memory.store();
  EXPECT_EQ(memory.stored, std::vector<std::string>{"A/b/c/once/1970-01-01 00:00:00.000000001"});
}

TEST(Leaving, TakesWhatIsLargeFirst) {
  PlainMemory memory(max_snapshots(2));
  memory.commit("A/b/c/large", 1, bytes(100'000));
  memory.commit("A/b/c/small", 1, bytes(10));
  memory.now += seconds(10);
  memory.commit("A/b/c/new", 1);
  memory.store();
  EXPECT_EQ(memory.stored, std::vector<std::string>{"A/b/c/large/1970-01-01 00:00:00.000000001"});
}

TEST(Leaving, KeepsWhatSomethingThatIsReadLinksTo) {
  PlainMemory memory(max_snapshots(3));
  ASSERT_TRUE(memory
                  ->declare(*MemoryId::parse("A/grasp"),
                            idf::Type::object("Grasp", {{"object", idf::Type::memory_link()}}))
                  .ok());
  memory.commit("A/b/c/cup", 1);
  memory.commit("A/b/c/table", 1);
  memory.commit("A/grasp/planner/left", 1, idf::Dict{{"object", "A/b/c/cup"}});
  memory.now += seconds(10);
  for (int i = 0; i < 5; ++i) memory.ask("A/grasp");
  memory.commit("A/b/c/new", 1);
  memory.store();
  EXPECT_EQ(memory.stored, std::vector<std::string>{"A/b/c/table/1970-01-01 00:00:00.000000001"});
  // The link is gone with what held it, and so is what was linked to.
  memory.commit("A/grasp/planner/left", 2, idf::Dict{{"object", ""}});
  memory->release_all();
  memory.store();
  EXPECT_EQ(memory->counters().entities, 0u);
}

/// What an entity with so many snapshots of 500 bytes takes.
size_t bytes_of_snapshots(int64_t count) {
  PlainMemory memory({});
  for (int64_t at = 0; at < count; ++at) memory.commit("Robot/joints/arm/left", at, bytes(500));
  return memory->counters().bytes;
}

TEST(Leaving, CountsWhatIsInRam) {
  const size_t one = bytes_of_snapshots(1), two = bytes_of_snapshots(2);
  EXPECT_GE(two - one, kSnapshotOverhead + 500);
  EXPECT_EQ(one, two - one + kEntityOverhead) << "an entity counts, too";
  PlainMemory memory({});
  memory.commit("A/b/c/d", 1, idf::Dict{{"a number", 1.0}, {"another number", 2.0}});
  EXPECT_GT(memory->counters().bytes,
            kSnapshotOverhead + kEntityOverhead + 2 * sizeof(idf::DictEntry))
      << "small values take more than their plain bytes";
  memory->release_all();
  memory.store();
  EXPECT_EQ(memory->counters().bytes, 0u);
}

TEST(Leaving, FollowsTheLimitsOfSegments) {
  WorkingMemory::Options options;
  options.segments = {{*MemoryId::parse("Vision"), {.snapshots = 1}},
                      {*MemoryId::parse("Robot/joints"), {.bytes = bytes_of_snapshots(2)}}};
  PlainMemory memory(options);
  for (const int64_t at : {1, 2, 3}) {
    memory.commit("Vision/RGB/head/cam", at);
    memory.commit("Robot/joints/arm/left", at, bytes(500));
    memory.commit("Robot/other/arm/left", at, bytes(5000));
  }
  memory.store();
  EXPECT_EQ(memory.times("Vision/RGB/head/cam"), std::vector<int64_t>{3});
  EXPECT_EQ(memory.times("Robot/joints/arm/left"), (std::vector<int64_t>{2, 3}));
  EXPECT_EQ(memory.times("Robot/other/arm/left").size(), 3u);
}

TEST(Leaving, TakesWhatIsTooOld) {
  WorkingMemory::Options options;
  options.all.age = seconds(5);
  PlainMemory memory(options);
  memory.commit("A/b/c/d", 1);
  memory.now += seconds(4);
  memory.commit("A/b/c/d", 2);
  memory.now += seconds(2);
  memory->expire();
  memory.store();
  EXPECT_EQ(memory.times("A/b/c/d"), std::vector<int64_t>{2});
}

TEST(Leaving, ShrinksWithItsLimits) {
  PlainMemory memory({});
  for (int64_t at = 0; at < 100; ++at) memory.commit("A/b/c/d", at);
  ASSERT_TRUE(memory->set_limits({.snapshots = 10}).ok());
  EXPECT_EQ(memory.store(), 90u);
  EXPECT_EQ(memory->counters().snapshots, 10u);
  EXPECT_FALSE(memory->set_limits({.bytes = 0}).ok());
}

TEST(Leaving, StoresEverythingAsItComesWhereAsked) {
  auto options = max_snapshots(2);
  options.mode = StoreMode::kEverything;
  PlainMemory memory(options);
  for (const int64_t at : {1, 2}) memory.commit("A/b/c/d", at);
  EXPECT_EQ(memory.store(), 2u);
  EXPECT_EQ(memory.times("A/b/c/d").size(), 2u) << "stored, and here";
  memory.commit("A/b/c/d", 3);
  EXPECT_EQ(memory.times("A/b/c/d"), (std::vector<int64_t>{2, 3})) << "was stored already";
  EXPECT_EQ(memory.store(), 1u);
  EXPECT_EQ(memory->counters().left, 1u);
}

TEST(Leaving, StoresTheLatestAtIntervalsWhereAsked) {
  auto options = max_snapshots(2);
  options.mode = StoreMode::kLatest;
  options.store_interval = seconds(10);
  PlainMemory memory(options);
  for (int64_t at = 0; at < 25; ++at) {
    memory.commit("A/b/c/d", at);
    memory.store();
    memory.now += seconds(1);
  }
  EXPECT_EQ(memory.stored.size(), 3u);
  const auto counts = memory->counters();
  EXPECT_EQ(counts.dropped, 20u);
  EXPECT_EQ(counts.left, 3u);
  EXPECT_EQ(counts.committed, counts.superseded + counts.left + counts.dropped + counts.snapshots);
}

TEST(Leaving, StoresACorrectionOfWhatWaits) {
  PlainMemory memory(max_snapshots(1));
  memory.commit("A/b/c/d", 1, "wrong");
  memory.commit("A/b/c/d", 2);
  memory.commit("A/b/c/d", 1, "right");
  std::vector<idf::Data> stored;
  const auto sink = [&](std::span<const SharedSnapshot> snapshots) {
    for (const auto& one : snapshots) stored.push_back(one->instances[0].data);
    return Status();
  };
  ASSERT_TRUE(memory->store(sink).ok());
  EXPECT_EQ(stored, (std::vector<idf::Data>{"wrong", "right"}));
  EXPECT_EQ(memory.times("A/b/c/d"), std::vector<int64_t>{2});
  const auto counts = memory->counters();
  EXPECT_EQ(counts.committed, counts.superseded + counts.left + counts.snapshots);
}

TEST(Leaving, ChoosesAmongManyEntities) {
  PlainMemory memory(max_snapshots(500));
  for (int i = 0; i < 2000; ++i) {
    memory.commit("A/b/c/" + std::to_string(i), 1);
    memory.now += std::chrono::milliseconds(10);
  }
  memory.store();
  const auto counts = memory->counters();
  EXPECT_EQ(counts.entities, 500u);
  EXPECT_EQ(counts.left, 1500u);
  size_t young = 0;
  for (int i = 1000; i < 2000; ++i)
    young += memory->find(*MemoryId::parse("A/b/c/" + std::to_string(i))) != nullptr ? 1 : 0;
  EXPECT_GT(young, 450u) << "what was held long went first";
}

}  // namespace
}  // namespace engram::ltm
