// SPDX-License-Identifier: Apache-2.0
// What working memory forgets: held snapshots, and those that wait for the online phase.
#include <gmock/gmock.h>

#include "tests/ltm/expect_status.h"
#include "tests/ltm/working/plain_memory.h"

namespace engram::ltm {
namespace {

using engram::testing::PlainMemory;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

using Gone = std::map<MemoryId, TimeSet>;

Gone of(const std::string& entity, std::vector<int64_t> times) {
  Gone gone;
  for (const int64_t at : times) gone[*MemoryId::parse(entity)].insert(time_from_ns(at));
  return gone;
}

WorkingMemory::Options everything() {
  WorkingMemory::Options options;
  options.mode = StoreMode::kEverything;
  return options;
}

void expect_sum(const MemoryCounters& counts) {
  EXPECT_EQ(counts.committed,
            counts.superseded + counts.left + counts.dropped + counts.forgotten + counts.snapshots);
}

TEST(WorkingMemoryForgetting, TakesOutTheseTimesAndNoOthers) {
  PlainMemory memory({});
  for (int64_t at = 1; at <= 6; ++at) {
    memory.commit("A/b/c/d", at);
    memory.commit("A/b/c/e", at);
  }
  const size_t bytes = memory->counters().bytes;
  EXPECT_EQ(memory->forget(of("A/b/c/d", {2, 3, 6, 99})), 3u);
  EXPECT_THAT(memory.times("A/b/c/d"), ElementsAre(1, 4, 5));
  EXPECT_THAT(memory.times("A/b/c/e"), ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_EQ(to_ns(memory->find(*MemoryId::parse("A/b/c/d"))->time), 5);
  EXPECT_LT(memory->counters().bytes, bytes);
  EXPECT_EQ(memory->counters().forgotten, 3u);
  expect_sum(memory->counters());
}

TEST(WorkingMemoryForgetting, LeavesNothingOfAnEntityThatIsGone) {
  PlainMemory memory({});
  memory.commit("A/b/c/d", 1);
  memory.commit("A/b/c/d", 2);
  EXPECT_EQ(memory->forget(of("A/b/c/d", {1, 2})), 2u);
  EXPECT_FALSE(memory->has(*MemoryId::parse("A/b/c/d")));
  EXPECT_EQ(memory->counters().entities, 0u);
  EXPECT_EQ(memory->counters().bytes, 0u);
  EXPECT_THAT(memory.ask("A @ all"), IsEmpty());
  memory.commit("A/b/c/d", 1);
  EXPECT_THAT(memory.times("A/b/c/d"), ElementsAre(1));
}

TEST(WorkingMemoryForgetting, NeverStoresWhatWaited) {
  PlainMemory memory(everything());
  for (int64_t at = 1; at <= 4; ++at) memory.commit("A/b/c/d", at, "value");
  std::vector<int64_t> unstored;
  memory->forget(of("A/b/c/d", {2, 3}), [&](std::span<const SharedSnapshot> waited) {
    for (const SharedSnapshot& one : waited) unstored.push_back(to_ns(one->time));
  });
  EXPECT_THAT(unstored, ElementsAre(2, 3));
  EXPECT_EQ(memory->counters().waiting, 2u);
  EXPECT_EQ(memory.store(), 2u);
  EXPECT_EQ(memory.stored.size(), 2u);
  EXPECT_EQ(memory->counters().waiting, 0u);
  EXPECT_EQ(memory->counters().waiting_bytes, 0u);
  memory->release_all();
  memory.store();
  EXPECT_EQ(memory.stored.size(), 2u);
  expect_sum(memory->counters());
}

TEST(WorkingMemoryForgetting, StoresNoOlderVersionOfTheSameTime) {
  PlainMemory memory(everything());
  memory.commit("A/b/c/d", 1, "wrong");
  memory.commit("A/b/c/d", 1, "right");
  memory->forget(of("A/b/c/d", {1}));
  EXPECT_EQ(memory.store(), 0u);
  EXPECT_THAT(memory.stored, IsEmpty());
  expect_sum(memory->counters());
}

// Those who wait count by places in the queue: one who waits for the first must not be told when
// the second is forgotten.
TEST(WorkingMemoryForgetting, KeepsThePlacesOfOthersInTheQueue) {
  PlainMemory memory(everything());
  const auto first = memory->admit({{PlainMemory::snapshot("A/b/c/d", 1, int64_t{0})}});
  memory.commit("A/b/c/d", 2);
  const auto third = memory->admit({{PlainMemory::snapshot("A/b/c/d", 3, int64_t{0})}});
  memory->forget(of("A/b/c/d", {2}));
  EXPECT_LT(memory->taken(), first->queued);
  EXPECT_EQ(memory.store(1), 1u);
  EXPECT_GE(memory->taken(), first->queued);
  EXPECT_LT(memory->taken(), third->queued);
  EXPECT_EQ(memory.store(), 1u);
  EXPECT_EQ(memory->taken(), third->queued);
  EXPECT_EQ(memory.stored.size(), 2u);
}

TEST(WorkingMemoryForgetting, AlsoTakesWhatIsLeaving) {
  WorkingMemory::Options options;
  options.all.snapshots = 2;
  PlainMemory memory(options);
  for (int64_t at = 1; at <= 5; ++at) memory.commit("A/b/c/d", at);
  EXPECT_EQ(memory->counters().waiting, 3u);
  EXPECT_EQ(memory->forget(of("A/b/c/d", {2, 4})), 2u);
  EXPECT_THAT(memory.times("A/b/c/d"), ElementsAre(1, 3, 5));
  EXPECT_EQ(memory.store(), 2u);
  EXPECT_THAT(memory.times("A/b/c/d"), ElementsAre(5));
  expect_sum(memory->counters());
  memory.commit("A/b/c/d", 6);
  EXPECT_EQ(memory->counters().waiting, 0u) << "the limit counts what stays";
}

}  // namespace
}  // namespace engram::ltm
