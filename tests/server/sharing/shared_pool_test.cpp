// SPDX-License-Identifier: Apache-2.0
#include "server/sharing/shared_pool.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <random>
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

TEST(SharedPool, GivesTheServerBlocksThatItWritesAndViews) {
  Pool pool;
  const BlockRef block = pool.lease(1000, kServerItself);
  EXPECT_EQ(block.offset % 64, 0u);
  EXPECT_EQ(block.capacity, 1024u);
  const auto bytes = pool->writable(block);
  ASSERT_TRUE(bytes.ok());
  std::memset(bytes->data(), 42, bytes->size());
  const auto buffer = pool->commit(kServerItself, kGroup, block, 1000);
  ASSERT_TRUE(buffer.ok());
  EXPECT_EQ(buffer->size(), 1000u);
  EXPECT_TRUE(std::ranges::all_of(buffer->bytes(), [](std::byte b) { return b == std::byte{42}; }));
  EXPECT_FALSE(pool->writable(block).ok());
}

TEST(SharedPool, ReusesABlockOnlyWhenItsLastViewIsGone) {
  Pool pool;
  const BlockRef first = pool.lease(5000);
  Buffer slice;
  {
    const Buffer whole = pool.commit(first);
    slice = whole.slice(100, 10);
  }
  const BlockRef second = pool.lease(5000);
  EXPECT_NE(second.offset, first.offset);
  slice = Buffer();
  const BlockRef third = pool.lease(5000);
  EXPECT_EQ(third.slab, first.slab);
  EXPECT_EQ(third.offset, first.offset);
  EXPECT_NE(third.generation, first.generation);
}

TEST(SharedPool, KeepsABlockForEachViewAndEachReader) {
  Pool pool;
  const BlockRef block = pool.lease(64);
  Buffer first = pool.commit(block);
  auto second = pool->view(block, 64);
  ASSERT_TRUE(second.ok());
  ASSERT_TRUE(pool->share(block, kReader).ok());
  ASSERT_TRUE(pool->share(block, kReader).ok());
  first = Buffer();
  EXPECT_EQ(pool->counters().blocks, 1u);
  second = Buffer();
  EXPECT_EQ(pool->counters().blocks, 1u);
  ASSERT_TRUE(pool->release(kReader, block).ok());
  EXPECT_EQ(pool->counters().shares, 1u);
  EXPECT_TRUE(pool->view(block, 64).ok()) << "a reader still has it";
  ASSERT_TRUE(pool->release(kReader, block).ok());
  EXPECT_EQ(pool->counters().blocks, 0u);
  EXPECT_EQ(code_of(pool->view(block, 64)), StatusCode::kInvalidArgument);
}

TEST(SharedPool, RefusesStaleBlocks) {
  Pool pool;
  const BlockRef stale = pool.lease(64);
  pool.commit(stale);
  const BlockRef fresh = pool.lease(64);
  ASSERT_EQ(fresh.offset, stale.offset);
  EXPECT_EQ(code_of(pool->commit(kWriter, kGroup, stale, 64)), StatusCode::kInvalidArgument);
  EXPECT_EQ(code_of(pool->abandon(kWriter, stale)), StatusCode::kInvalidArgument);
  EXPECT_EQ(code_of(pool->share(stale, kReader)), StatusCode::kInvalidArgument);
  EXPECT_EQ(code_of(pool->release(kReader, stale)), StatusCode::kInvalidArgument);
  EXPECT_EQ(pool->counters().refused, 4u);
  EXPECT_EQ(pool->counters().blocks, 1u);
}

TEST(SharedPool, RefusesForgedBlocks) {
  Pool pool;
  const BlockRef block = pool.lease(256);
  const BlockRef beside = pool.lease(256);
  std::vector<BlockRef> forged(9, block);
  forged[0].slab += 1;
  forged[1].slab = UINT64_MAX;
  forged[2].offset += 64;
  forged[3].offset = beside.offset;
  forged[4].offset = UINT64_MAX - 63;
  forged[5].capacity += 64;
  forged[6].capacity = UINT64_MAX;
  forged[7].generation = 0;
  forged[8].generation += 1;
  for (const BlockRef& one : forged) {
    EXPECT_EQ(code_of(pool->commit(kWriter, kGroup, one, 1)), StatusCode::kInvalidArgument);
    EXPECT_EQ(code_of(pool->abandon(kWriter, one)), StatusCode::kInvalidArgument);
  }
  EXPECT_EQ(code_of(pool->commit(kWriter, kGroup, BlockRef{}, 1)), StatusCode::kInvalidArgument);
  EXPECT_EQ(pool->counters().uncommitted, 2u);
}

TEST(SharedPool, RefusesMoreBytesThanABlockHasAndNone) {
  Pool pool;
  const BlockRef block = pool.lease(100);
  for (const size_t bytes : {size_t{0}, size_t{129}, SIZE_MAX})
    EXPECT_EQ(code_of(pool->commit(kWriter, kGroup, block, bytes)), StatusCode::kInvalidArgument);
  const auto buffer = pool->commit(kWriter, kGroup, block, 100);
  ASSERT_TRUE(buffer.ok());
  EXPECT_FALSE(pool->view(block, 101).ok());
  EXPECT_TRUE(pool->view(block, 100).ok());
}

TEST(SharedPool, RefusesBlocksOfAnotherWriterOrGroup) {
  Pool pool;
  const BlockRef block = pool.lease(64);
  EXPECT_EQ(code_of(pool->commit(kOther, kGroup, block, 64)), StatusCode::kInvalidArgument);
  EXPECT_EQ(code_of(pool->commit(kServerItself, kGroup, block, 64)), StatusCode::kInvalidArgument);
  EXPECT_EQ(code_of(pool->commit(kWriter, kGroup + 1, block, 64)), StatusCode::kInvalidArgument);
  EXPECT_EQ(code_of(pool->abandon(kOther, block)), StatusCode::kInvalidArgument);
  EXPECT_EQ(code_of(pool->writable(block)), StatusCode::kInvalidArgument);
  EXPECT_NE(pool.lease(64, kOther).slab, block.slab);
  EXPECT_NE(pool.lease(64, kWriter, kGroup + 1).slab, block.slab);
}

TEST(SharedPool, CommitsABlockOnce) {
  Pool pool;
  const BlockRef block = pool.lease(64);
  const Buffer kept = pool.commit(block);
  EXPECT_EQ(code_of(pool->commit(kWriter, kGroup, block, 64)), StatusCode::kInvalidArgument);
  EXPECT_EQ(code_of(pool->abandon(kWriter, block)), StatusCode::kInvalidArgument);
}

TEST(SharedPool, ViewsAndSharesOnlyWhatWasCommitted) {
  Pool pool;
  const BlockRef block = pool.lease(64);
  EXPECT_EQ(code_of(pool->view(block, 64)), StatusCode::kInvalidArgument);
  EXPECT_EQ(code_of(pool->share(block, kReader)), StatusCode::kInvalidArgument);
}

TEST(SharedPool, CommitsNothingThatItsWriterCouldNotHaveMapped) {
  Pool pool;
  const auto block = pool->lease(kWriter, kGroup, 64);
  ASSERT_TRUE(block.ok());
  EXPECT_EQ(code_of(pool->commit(kWriter, kGroup, *block, 64)), StatusCode::kFailedPrecondition);
  EXPECT_EQ(code_of(pool->seal(kOther, block->slab)), StatusCode::kNotFound);
  ASSERT_TRUE(pool->seal(kWriter, block->slab).ok());
  EXPECT_TRUE(pool->commit(kWriter, kGroup, *block, 64).ok());
}

TEST(SharedPool, SharesOnlyWithReadersThatHaveAGrant) {
  Pool pool;
  const BlockRef block = pool.lease(64);
  const Buffer kept = pool.commit(block);
  EXPECT_EQ(code_of(pool->share(block, kOther)), StatusCode::kFailedPrecondition);
  EXPECT_EQ(code_of(pool->share(block, 99)), StatusCode::kFailedPrecondition);
  EXPECT_EQ(code_of(pool->grant_read(99, kGroup)), StatusCode::kFailedPrecondition);
  EXPECT_EQ(code_of(pool->open_slab(kOther, block.slab)), StatusCode::kNotFound);
  EXPECT_EQ(code_of(pool->open_slab(kReader, block.slab + 1)), StatusCode::kNotFound);
  const auto opened = pool->open_slab(kReader, block.slab);
  ASSERT_TRUE(opened.ok()) << opened.status().to_string();
  EXPECT_FALSE(opened->is_writer);
}

TEST(SharedPool, OpensASlabForReadersWhenItsWriterHasMappedIt) {
  Pool pool;
  const auto block = pool->lease(kWriter, kGroup, 64);
  EXPECT_EQ(code_of(pool->open_slab(kReader, block->slab)), StatusCode::kFailedPrecondition);
  EXPECT_TRUE(pool->open_slab(kWriter, block->slab)->is_writer);
  ASSERT_TRUE(pool->seal(kWriter, block->slab).ok());
  EXPECT_EQ(code_of(pool->open_slab(kWriter, block->slab)), StatusCode::kFailedPrecondition);
  EXPECT_TRUE(pool->open_slab(kReader, block->slab).ok());
}

TEST(SharedPool, ReleasesNoMoreThanAReaderHas) {
  Pool pool;
  const BlockRef block = pool.lease(64);
  const Buffer kept = pool.commit(block);
  EXPECT_EQ(code_of(pool->release(kReader, block)), StatusCode::kInvalidArgument);
  ASSERT_TRUE(pool->share(block, kReader).ok());
  for (const uint64_t count : {uint64_t{0}, uint64_t{2}, UINT64_MAX})
    EXPECT_EQ(code_of(pool->release(kReader, block, count)), StatusCode::kInvalidArgument);
  EXPECT_EQ(code_of(pool->release(kOther, block)), StatusCode::kInvalidArgument);
  BlockRef forged = block;
  forged.offset += 64;
  EXPECT_EQ(code_of(pool->release(kReader, forged)), StatusCode::kInvalidArgument);
  EXPECT_TRUE(pool->release(kReader, block).ok());
}

TEST(SharedPool, TakesBackWhatAWriterDidNotCommit) {
  Pool pool(small());
  const BlockRef committed = pool.lease(64);
  Buffer kept = pool.commit(committed);
  pool.lease(64);
  pool.lease(64);
  pool->remove_client(kWriter);
  EXPECT_EQ(pool->counters().uncommitted, 0u);
  EXPECT_EQ(pool->counters().blocks, 1u);
  EXPECT_EQ(pool->counters().slabs, 1u) << "somebody still reads it";
  EXPECT_TRUE(pool->share(committed, kReader).ok());
  kept = Buffer();
  EXPECT_EQ(pool->counters().slabs, 1u);
  ASSERT_TRUE(pool->release(kReader, committed).ok());
  EXPECT_EQ(pool->counters().slabs, 0u);
  EXPECT_EQ(pool->counters().slab_bytes, 0u);
}

TEST(SharedPool, GivesAClientOfTheSameNameNothingOfTheOneBefore) {
  Pool pool(small());
  const BlockRef old = pool.lease(64);
  const Buffer kept = pool.commit(old);
  const BlockRef uncommitted = pool.lease(64);
  pool->remove_client(kWriter);
  ASSERT_TRUE(pool->add_client(kWriter).ok());
  EXPECT_EQ(code_of(pool->commit(kWriter, kGroup, uncommitted, 64)), StatusCode::kInvalidArgument);
  EXPECT_EQ(code_of(pool->open_slab(kWriter, old.slab)), StatusCode::kNotFound);
  EXPECT_NE(pool.lease(64).slab, old.slab);
}

TEST(SharedPool, TakesBackWhatAReaderHad) {
  Pool pool;
  const BlockRef block = pool.lease(64);
  {
    const Buffer kept = pool.commit(block);
    ASSERT_TRUE(pool->share(block, kReader).ok());
    ASSERT_TRUE(pool->share(block, kReader).ok());
  }
  EXPECT_EQ(pool->counters().blocks, 1u);
  pool->remove_client(kReader);
  EXPECT_EQ(pool->counters().blocks, 0u);
  EXPECT_EQ(pool->counters().shares, 0u);
  EXPECT_EQ(code_of(pool->release(kReader, block)), StatusCode::kInvalidArgument);
}

TEST(SharedPool, KnowsItsClients) {
  Pool pool;
  EXPECT_EQ(code_of(pool->add_client(kWriter)), StatusCode::kAlreadyExists);
  EXPECT_EQ(code_of(pool->add_client(kServerItself)), StatusCode::kInvalidArgument);
  EXPECT_EQ(code_of(pool->lease(99, kGroup, 64)), StatusCode::kFailedPrecondition);
  pool->remove_client(99);
  pool->remove_client(kServerItself);
  EXPECT_TRUE(pool->lease(kServerItself, kGroup, 64).ok());
  EXPECT_EQ(pool->counters().clients, 3u);
}

TEST(SharedPool, FindsTheBlockThatBytesLieIn) {
  Pool pool;
  const BlockRef first = pool.lease(1000);
  const BlockRef second = pool.lease(1000);
  const Buffer one = *pool->commit(kWriter, kGroup, first, 1000);
  const Buffer two = *pool->commit(kWriter, kGroup, second, 1000);
  const auto located = pool->locate(two.slice(300, 700).bytes());
  ASSERT_TRUE(located.has_value());
  EXPECT_EQ(located->block, second);
  EXPECT_EQ(located->offset, 300u);
  EXPECT_EQ(pool->locate(one.bytes())->block, first);
  const std::vector<std::byte> elsewhere(100);
  EXPECT_FALSE(pool->locate(elsewhere).has_value());
  EXPECT_FALSE(pool->locate({}).has_value());
  EXPECT_FALSE(pool->locate({one.data() + 999, 2}).has_value()) << "beyond what was committed";
  EXPECT_FALSE(pool->locate({two.data() + 2000, 2}).has_value()) << "nothing was leased there";
}

TEST(SharedPool, LeavesBuffersReadableThatOutliveIt) {
  Buffer kept;
  {
    Pool pool;
    const BlockRef block = pool.lease(5000, kServerItself);
    std::memset(pool->writable(block)->data(), 9, 5000);
    kept = pool.commit(block, kServerItself).slice(10, 100);
    pool.lease(64);
  }
  EXPECT_TRUE(std::ranges::all_of(kept.bytes(), [](std::byte b) { return b == std::byte{9}; }));
}

TEST(SharedPool, RefusesOptionsThatCannotBe) {
  auto options = small();
  options.first_slab_bytes = 0;
  EXPECT_FALSE(SharedPool::create(options).ok());
  options = small();
  options.slab_bytes = 5 * kMiB;
  EXPECT_FALSE(SharedPool::create(options).ok());
  options = small();
  options.keep_free = Duration(-1);
  EXPECT_FALSE(SharedPool::create(options).ok());
}

TEST(SharedPool, NeverGivesOutMemoryThatIsInUse) {
  auto options = small();
  options.max_bytes = 64 * kMiB;
  options.max_writer_bytes = 8 * kMiB;
  Pool pool(options);
  std::mt19937 random(1);
  struct Held {
    BlockRef block;
    Buffer bytes;
    int value;
  };
  std::vector<Held> held;
  size_t refused = 0;
  for (int step = 0; step < 20'000; ++step) {
    if (!held.empty() && random() % 100 < 48) {
      std::swap(held[random() % held.size()], held.back());
      const Held& one = held.back();
      ASSERT_EQ(std::to_integer<int>(one.bytes.bytes().front()), one.value);
      ASSERT_EQ(std::to_integer<int>(one.bytes.bytes().back()), one.value);
      held.pop_back();
      continue;
    }
    const size_t bytes = size_t{1} << (random() % 20);
    const GroupId group = random() % 3;
    const auto block = pool->lease(kServerItself, group, bytes);
    if (!block.ok()) {
      ++refused;
      held.resize(held.size() / 2);
      continue;
    }
    const int value = static_cast<int>(random() % 256);
    const auto span = *pool->writable(*block);
    span.front() = span.back() = std::byte(value);
    held.push_back({*block, *pool->commit(kServerItself, group, *block, block->capacity), value});
  }
  EXPECT_GT(refused, 0u);
  held.clear();
  EXPECT_EQ(pool->counters().blocks, 0u);
  EXPECT_EQ(pool->counters().block_bytes, 0u);
  pool->trim(time_from_ns(0));
  pool->trim(time_from_ns(0) + options.keep_free);
  EXPECT_EQ(pool->counters().slabs, 0u);
  EXPECT_EQ(pool->counters().slab_bytes, 0u);
}

}  // namespace
}  // namespace engram::server
