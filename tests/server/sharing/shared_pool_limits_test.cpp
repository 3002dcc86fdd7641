// SPDX-License-Identifier: Apache-2.0
// How much memory a pool gives whom, and when it gives it back.
#include <gtest/gtest.h>

#include <vector>

#include "tests/server/sharing/pool.h"

namespace engram::server {
namespace {

using testing::code_of;
using testing::kGroup;
using testing::kMiB;
using testing::kOther;
using testing::kReader;
using testing::kWriter;
using testing::Pool;
using testing::small;

TEST(SharedPool, IsBoundedInAllAndForEachWriter) {
  Pool pool(small());
  EXPECT_EQ(code_of(pool->lease(kWriter, kGroup, 0)), StatusCode::kInvalidArgument);
  EXPECT_EQ(code_of(pool->lease(kWriter, kGroup, 4 * kMiB + 1)), StatusCode::kResourceExhausted);
  EXPECT_EQ(code_of(pool->lease(kWriter, kGroup, SIZE_MAX)), StatusCode::kResourceExhausted);
  pool.lease(kMiB);
  pool.lease(kMiB);
  EXPECT_EQ(code_of(pool->lease(kWriter, kGroup, 64)), StatusCode::kResourceExhausted);
  pool.lease(2 * kMiB, kOther);
  EXPECT_EQ(code_of(pool->lease(kReader, kGroup, 64)), StatusCode::kResourceExhausted);
  EXPECT_EQ(pool->counters().slab_bytes, 4 * kMiB);
  EXPECT_EQ(pool->counters().exhausted, 4u);
  pool->remove_client(kOther);
  EXPECT_TRUE(pool->lease(kReader, kGroup, 64).ok());
}

TEST(SharedPool, GivesIdleSlabsUpBeforeItRefuses) {
  Pool pool(small());
  for (const BlockRef& block : {pool.lease(kMiB), pool.lease(kMiB)})
    ASSERT_TRUE(pool->abandon(kWriter, block).ok());
  ASSERT_EQ(pool->counters().slab_bytes, 2 * kMiB);
  pool.lease(2 * kMiB);
  EXPECT_EQ(pool->counters().slab_bytes, 2 * kMiB);
}

TEST(SharedPool, IsBoundedInBlocks) {
  auto options = small();
  options.max_writer_blocks = 3;
  Pool pool(options);
  const BlockRef first = pool.lease(64);
  pool.lease(64);
  pool.lease(64);
  EXPECT_EQ(code_of(pool->lease(kWriter, kGroup, 64)), StatusCode::kResourceExhausted);
  ASSERT_TRUE(pool->abandon(kWriter, first).ok());
  pool.lease(64);
}

TEST(SharedPool, IsBoundedInWhatAReaderHas) {
  auto options = small();
  options.max_reader_bytes = 128;
  Pool pool(options);
  const BlockRef first = pool.lease(128);
  const BlockRef second = pool.lease(64);
  const std::vector<Buffer> kept{pool.commit(first), pool.commit(second)};
  ASSERT_TRUE(pool->share(first, kReader).ok());
  EXPECT_TRUE(pool->share(first, kReader).ok()) << "it has that already";
  EXPECT_EQ(code_of(pool->share(second, kReader)), StatusCode::kResourceExhausted);
  ASSERT_TRUE(pool->release(kReader, first, 2).ok());
  EXPECT_TRUE(pool->share(second, kReader).ok());
}

TEST(SharedPool, GivesLargeBlocksASlabOfTheirOwn) {
  Pool pool;
  const BlockRef block = pool.lease(100 * kMiB + 1);
  EXPECT_EQ(block.offset, 0u);
  EXPECT_EQ(block.capacity, 100 * kMiB + 64);
  EXPECT_EQ(pool->counters().slab_bytes, 100 * kMiB + 4096);
}

TEST(SharedPool, AddsAsMuchAsThereIsUntilSlabsAreLarge) {
  SharedPool::Options options;
  options.slab_bytes = 16 * kMiB;
  Pool pool(options);
  for (const size_t total : {4, 8, 16, 32, 48, 64}) {
    while (pool->counters().block_bytes < total * kMiB) pool.lease(2 * kMiB);
    EXPECT_EQ(pool->counters().slab_bytes, total * kMiB);
  }
}

TEST(SharedPool, TakesAllThatIsLeftWhereThatIsLessThanASlab) {
  auto options = small();
  options.max_writer_bytes = kMiB + kMiB / 2;
  Pool pool(options);
  pool.lease(kMiB);
  for (int i = 0; i < 8; ++i) pool.lease(kMiB / 16);
  EXPECT_EQ(pool->counters().slabs, 2u);
  EXPECT_EQ(code_of(pool->lease(kWriter, kGroup, 64)), StatusCode::kResourceExhausted);
}

TEST(SharedPool, GivesSlabsBackThatWereIdleForLongEnough) {
  auto options = small();
  options.keep_free = std::chrono::seconds(10);
  Pool pool(options);
  const BlockRef block = pool.lease(64);
  const Time start = time_from_ns(1'000'000'000'000);
  pool->trim(start);
  ASSERT_TRUE(pool->abandon(kWriter, block).ok());
  pool->trim(start + std::chrono::seconds(20));
  pool->trim(start + std::chrono::seconds(29));
  EXPECT_TRUE(pool->has_slab(block.slab)) << "idle since it was first seen to be";
  const BlockRef again = pool.lease(64);
  ASSERT_TRUE(pool->abandon(kWriter, again).ok());
  pool->trim(start + std::chrono::seconds(31));
  EXPECT_TRUE(pool->has_slab(block.slab)) << "it was used meanwhile";
  pool->trim(start + std::chrono::seconds(41));
  EXPECT_FALSE(pool->has_slab(block.slab));
  EXPECT_NE(pool.lease(64).slab, block.slab) << "names are used once";
}

}  // namespace
}  // namespace engram::server
