// SPDX-License-Identifier: Apache-2.0
#include "server/sharing/sharing_client.h"

#include "tests/server/sharing/shared_host.h"

namespace engram::server {
namespace {

using engram::testing::becomes_true;
using engram::testing::SharedHost;

constexpr ClientId kWriter = 1;
constexpr ClientId kReader = 2;
constexpr GroupId kGroup = 7;

bool is_all(const Buffer& buffer, int value) {
  return std::ranges::all_of(buffer.bytes(), [=](std::byte b) { return b == std::byte(value); });
}

/// A host, a writer and a reader, and a block that went from one to the other.
struct Shared {
  Shared() : writer(host.connect(kWriter)), reader(host.connect(kReader, {kGroup})) {
    kept = host.commit(*writer, kWriter, kGroup, 5000, 42, &block);
    EXPECT_TRUE(host.pool->share(block, kReader).ok());
  }

  SharedHost host;
  std::unique_ptr<SharingClient> writer;
  std::unique_ptr<SharingClient> reader;
  BlockRef block;
  Buffer kept;
};

TEST(SharingClient, ReadsWhatAnotherWrote) {
  Shared shared;
  EXPECT_TRUE(is_all(shared.kept, 42));
  const auto read = shared.reader->readable(shared.block, 5000);
  ASSERT_TRUE(read.ok()) << read.status().to_string();
  EXPECT_TRUE(is_all(*read, 42));
  EXPECT_NE(read->data(), shared.kept.data()) << "a mapping of its own";
}

TEST(SharingClient, ReadsWhatTheServerWrote) {
  Shared shared;
  const BlockRef block = *shared.host.pool->lease(kServerItself, kGroup, 100);
  std::ranges::fill(*shared.host.pool->writable(block), std::byte{5});
  const auto kept = shared.host.pool->commit(kServerItself, kGroup, block, 100);
  EXPECT_TRUE(is_all(*shared.reader->readable(block, 100), 5));
}

TEST(SharingClient, ReadsWhatItWroteItself) {
  Shared shared;
  EXPECT_TRUE(is_all(*shared.writer->readable(shared.block, 5000), 42));
}

TEST(SharingClient, SaysWhenTheLastCopyOfABufferIsGone) {
  Shared shared;
  Buffer slice = shared.reader->readable(shared.block, 5000)->slice(10, 10);
  EXPECT_TRUE(shared.reader->take_released().empty());
  slice = Buffer();
  EXPECT_EQ(shared.reader->take_released(), std::vector<BlockRef>{shared.block});
  EXPECT_TRUE(shared.reader->take_released().empty());
  int called = 0;
  slice = *shared.reader->readable(shared.block, 1, [&](const BlockRef& block) {
    EXPECT_EQ(block, shared.block);
    ++called;
  });
  EXPECT_EQ(called, 0);
  slice = Buffer();
  EXPECT_EQ(called, 1);
  EXPECT_TRUE(shared.reader->take_released().empty());
}

TEST(SharingClient, RefusesBlocksThatDoNotLieInTheirSlab) {
  Shared shared;
  std::vector<BlockRef> forged(4, shared.block);
  forged[0].offset = UINT64_MAX - 63;
  forged[1].capacity = UINT64_MAX;
  forged[2].offset = size_t{4} << 20;
  forged[3].capacity = (size_t{4} << 20) + 64;
  for (const BlockRef& block : forged) {
    EXPECT_EQ(shared.reader->readable(block, 1).status().code(), StatusCode::kInvalidArgument);
    EXPECT_EQ(shared.writer->writable(block).status().code(), StatusCode::kInvalidArgument);
  }
  EXPECT_EQ(shared.reader->readable(shared.block, shared.block.capacity + 1).status().code(),
            StatusCode::kInvalidArgument);
  EXPECT_EQ(shared.reader->writable(shared.block).status().code(), StatusCode::kInvalidArgument);
  BlockRef nowhere = shared.block;
  nowhere.slab = 1000;
  EXPECT_EQ(shared.reader->readable(nowhere, 1).status().code(), StatusCode::kNotFound);
}

TEST(SharingClient, KeepsBuffersReadableWhenTheServerIsGone) {
  Shared shared;
  const Buffer read = *shared.reader->readable(shared.block, 5000);
  shared.host.server.reset();
  EXPECT_TRUE(becomes_true([&] { return !shared.reader->is_connected(); }));
  EXPECT_EQ(shared.reader->readable(shared.block, 1).status().code(), StatusCode::kUnavailable);
  EXPECT_TRUE(becomes_true([&] { return !shared.writer->is_connected(); }));
  EXPECT_EQ(shared.writer->writable(shared.block).status().code(), StatusCode::kUnavailable);
  shared.kept = Buffer();
  shared.host.pool.reset();
  EXPECT_TRUE(is_all(read, 42));
  shared.reader.reset();
  EXPECT_TRUE(is_all(read, 42)) << "it outlives the client, too";
}

TEST(SharingClient, UnmapsWhatTheServerGaveBack) {
  SharedPool::Options options;
  options.keep_free = Duration(0);
  SharedHost host(options);
  const auto writer = host.connect(kWriter);
  BlockRef block;
  host.commit(*writer, kWriter, kGroup, 5000, 42, &block);
  EXPECT_TRUE(becomes_true(
      [&] { return writer->writable(block).status().code() == StatusCode::kNotFound; }));
  EXPECT_EQ(host.pool->counters().slabs, 0u);
  const Buffer again = host.commit(*writer, kWriter, kGroup, 5000, 43, &block);
  EXPECT_TRUE(is_all(again, 43));
}

TEST(SharingClient, ConnectsAgainToAServerThatWasStartedAgain) {
  Shared shared;
  shared.host.server.reset();
  shared.host.pool = std::move(*SharedPool::create({}));
  auto options = SharedHost::quick();
  options.socket = shared.host.socket();
  shared.host.server = std::move(*SharingServer::start(*shared.host.pool, options));
  const auto again = shared.host.connect(kWriter);
  ASSERT_NE(again, nullptr);
  EXPECT_TRUE(is_all(shared.host.commit(*again, kWriter, kGroup, 100, 3), 3));
  EXPECT_FALSE(shared.writer->is_connected());
}

TEST(SharingClient, SaysThatThereIsNoServer) {
  const engram::testing::Scratch scratch;
  EXPECT_EQ(SharingClient::connect(scratch / "none", {}, {}).status().code(),
            StatusCode::kUnavailable);
  EXPECT_EQ(SharingClient::connect("", {}, {}).status().code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(SharingClient::connect(std::string(108, 'x'), {}, {}).status().code(),
            StatusCode::kInvalidArgument);
}

TEST(SharingClient, IsRefusedWithoutAGoodTicket) {
  SharedHost host;
  EXPECT_EQ(SharingClient::connect(host.socket(), {}, {}).status().code(), StatusCode::kNotFound);
  const Ticket ticket = *host.server->issue_ticket(kWriter);
  const auto client = SharingClient::connect(host.socket(), ticket, {});
  EXPECT_TRUE(client.ok());
  EXPECT_EQ(SharingClient::connect(host.socket(), ticket, {}).status().code(),
            StatusCode::kNotFound);
  const Ticket second = *host.server->issue_ticket(kWriter);
  EXPECT_EQ(SharingClient::connect(host.socket(), second, {}).status().code(),
            StatusCode::kAlreadyExists);
  EXPECT_TRUE((*client)->is_connected());
  EXPECT_TRUE(becomes_true([&] { return host.server->counters().refused == 3; }));
}

}  // namespace
}  // namespace engram::server
