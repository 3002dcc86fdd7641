// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <atomic>
#include <thread>

#include "tests/ltm/working/plain_memory.h"

namespace engram::ltm {
namespace {

TEST(ParallelMemory, LosesNothingBetweenWritersReadersAndTheOnlinePhase) {
  constexpr int kWriters = 4;
  constexpr int64_t kEach = 2000;
  WorkingMemory::Options options;
  options.all.snapshots = 50;
  auto memory = std::move(*WorkingMemory::create(options));
  std::atomic<int> writing{kWriters};
  std::vector<std::vector<int64_t>> stored(kWriters);
  const auto sink = [&](std::span<const SharedSnapshot> snapshots) {
    for (const auto& one : snapshots)
      stored[static_cast<size_t>(one->instances[0].data.get<int64_t>())].push_back(
          to_ns(one->time));
    return Status();
  };
  {
    std::vector<std::jthread> threads;
    for (int writer = 0; writer < kWriters; ++writer)
      threads.emplace_back([&, writer] {
        const std::string entity = "A/b/c/" + std::to_string(writer);
        for (int64_t at = 1; at <= kEach; ++at) {
          const Status done = memory->commit(
              {{engram::testing::PlainMemory::snapshot(entity, at, int64_t{writer})}});
          EXPECT_TRUE(done.ok()) << done.to_string();
        }
        --writing;
      });
    for (int reader = 0; reader < 2; ++reader)
      threads.emplace_back([&] {
        const auto query = *Query::parse("A @ all");
        while (writing > 0)
          for (const SelectedEntity& one : memory->select(query))
            EXPECT_TRUE(std::ranges::is_sorted(one.snapshots, {},
                                               [](const auto& found) { return found->time; }));
      });
    threads.emplace_back([&] {
      while (writing > 0) EXPECT_TRUE(memory->store(sink, 10'000).ok());
    });
  }
  memory->release_all();
  ASSERT_TRUE(memory->store(sink).ok());
  for (const auto& times : stored) {
    ASSERT_EQ(times.size(), static_cast<size_t>(kEach));
    EXPECT_TRUE(std::ranges::is_sorted(times));
  }
  EXPECT_EQ(memory->counters().entities, 0u);
  EXPECT_EQ(memory->counters().committed, static_cast<uint64_t>(kWriters * kEach));
}

}  // namespace
}  // namespace engram::ltm
