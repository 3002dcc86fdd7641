// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <chrono>
#include <latch>
#include <random>

#include "tests/server/sharing/shared_host.h"

namespace engram::server {
namespace {

using engram::testing::becomes_true;
using engram::testing::SharedHost;

constexpr GroupId kGroup = 7;

/// Commits blocks of one value each, and checks that those it keeps still have theirs.
void write_and_check(SharedHost& host, SharingClient& client, ClientId name, SharingClient& reader,
                     ClientId reader_name) {
  std::mt19937 random(static_cast<unsigned>(name));
  std::vector<std::pair<Buffer, int>> kept;
  for (int step = 0; step < 500; ++step) {
    const int value = static_cast<int>(random() % 256);
    const size_t bytes = 1 + random() % 20'000;
    BlockRef block;
    Buffer buffer = host.commit(client, name, kGroup, bytes, value, &block);
    ASSERT_EQ(buffer.size(), bytes);
    if (step % 3 == 0) {
      ASSERT_TRUE(host.pool->share(block, reader_name).ok());
      const auto read = reader.readable(block, bytes);
      ASSERT_TRUE(read.ok()) << read.status().to_string();
      EXPECT_EQ(read->bytes().back(), std::byte(value));
    }
    kept.emplace_back(buffer.slice(bytes / 2, bytes - bytes / 2), value);
    if (kept.size() > 20) {
      std::swap(kept[random() % kept.size()], kept.back());
      for (const std::byte byte : kept.back().first.bytes())
        ASSERT_EQ(byte, std::byte(kept.back().second));
      kept.pop_back();
    }
  }
}

TEST(ParallelSharing, MixesNothingUpBetweenManyWritersAndReaders) {
  constexpr ClientId kWriters = 4;
  constexpr ClientId kReader = 100;
  SharedPool::Options options;
  options.first_slab_bytes = 64 << 10;
  options.keep_free = Duration(0);  // Slabs come and go all the time.
  SharedHost host(options);
  const auto reader = host.connect(kReader, {kGroup});
  {
    std::atomic<ClientId> writing{kWriters};
    std::vector<std::jthread> threads;
    for (ClientId name = 1; name <= kWriters; ++name)
      threads.emplace_back([&, name] {
        const auto client = host.connect(name);
        write_and_check(host, *client, name, *reader, kReader);
        --writing;
      });
    threads.emplace_back([&] {
      while (writing > 0)
        for (const BlockRef& block : reader->take_released())
          EXPECT_TRUE(host.pool->release(kReader, block).ok());
    });
    threads.emplace_back([&] {
      for (ClientId name = 1000; writing > 0; ++name) {
        const auto passing = host.connect(name);
        EXPECT_TRUE(host.pool->lease(name, kGroup, 1000).ok());
        host.pool->trim(system_now());
        EXPECT_GE(host.pool->counters().clients, 1u);
      }
    });
  }
  for (const BlockRef& block : reader->take_released())
    EXPECT_TRUE(host.pool->release(kReader, block).ok());
  EXPECT_TRUE(becomes_true([&] { return host.pool->counters().clients == 1; }));
  EXPECT_EQ(host.pool->counters().blocks, 0u);
  EXPECT_EQ(host.pool->counters().shares, 0u);
  EXPECT_EQ(host.pool->counters().refused, 0u);
}

/// Eight threads write blocks of one slab that their client does not know yet, at moments around
/// the server's answer.
void write_at_once(std::mt19937& random) {
  SharedHost host;
  const auto client = host.connect(1);
  std::vector<BlockRef> blocks;
  for (int i = 0; i < 8; ++i) blocks.push_back(*host.pool->lease(1, kGroup, 1000));
  {
    std::latch ready(8);
    std::vector<std::jthread> threads;
    for (const BlockRef& block : blocks)
      threads.emplace_back([&, wait = std::chrono::microseconds(random() % 200)] {
        ready.arrive_and_wait();
        const auto begin = std::chrono::steady_clock::now() + wait;
        while (std::chrono::steady_clock::now() < begin) std::this_thread::yield();
        const auto span = client->writable(block);
        ASSERT_TRUE(span.ok()) << span.status().to_string();
        std::ranges::fill(*span, std::byte{1});
      });
  }
  for (const BlockRef& block : blocks) EXPECT_TRUE(host.pool->commit(1, kGroup, block, 1000).ok());
}

// A server refuses a slab that was asked for twice; to come between a thread's look and its lock
// takes many tries.
TEST(ParallelSharing, AsksForASlabOnceForAllThreads) {
  std::mt19937 random(1);
  for (int i = 0; i < 1000 && !::testing::Test::HasFailure(); ++i) write_at_once(random);
}

}  // namespace
}  // namespace engram::server
