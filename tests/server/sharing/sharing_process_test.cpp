// SPDX-License-Identifier: Apache-2.0
// Clients in processes of their own, which are killed.
#include <sstream>

#include "tests/server/sharing/shared_host.h"

namespace engram::server {
namespace {

using engram::testing::becomes_true;
using engram::testing::PeerProcess;
using engram::testing::SharedHost;
using engram::testing::words_of;

constexpr ClientId kWriter = 1;
constexpr ClientId kReader = 2;
constexpr GroupId kGroup = 7;
constexpr size_t kBytes = 4'900'032;

/// A host with a writer and a reader, each a process.
struct TwoProcesses {
  TwoProcesses() : writer(host.scratch), reader(host.scratch) {
    EXPECT_EQ(writer.connect(host, kWriter), "ok");
    EXPECT_EQ(reader.connect(host, kReader, {kGroup}), "ok");
  }

  BlockRef lease() { return *host.pool->lease(kWriter, kGroup, kBytes); }
  std::string fill(const BlockRef& block, int value) {
    return writer.tell("fill " + words_of(block) + " " + std::to_string(value));
  }
  Buffer commit(const BlockRef& block) {
    return *host.pool->commit(kWriter, kGroup, block, kBytes);
  }

  SharedHost host;
  PeerProcess writer;
  PeerProcess reader;
};

TEST(SharingProcess, ReadsInOneProcessWhatAnotherWrote) {
  TwoProcesses two;
  const BlockRef block = two.lease();
  ASSERT_EQ(two.fill(block, 42), "ok");
  Buffer kept = two.commit(block);
  EXPECT_EQ(kept.bytes().front(), std::byte{42});
  EXPECT_EQ(kept.bytes().back(), std::byte{42});
  ASSERT_TRUE(two.host.pool->share(block, kReader).ok());
  EXPECT_EQ(two.reader.tell("read " + words_of(block)), "42");
  kept = Buffer();
  EXPECT_EQ(two.host.pool->counters().blocks, 1u);
  EXPECT_EQ(two.reader.tell("drop"), "1");
  ASSERT_TRUE(two.host.pool->release(kReader, block).ok());
  EXPECT_EQ(two.host.pool->counters().blocks, 0u);
}

TEST(SharingProcess, KillsAReaderThatWrites) {
  TwoProcesses two;
  const BlockRef block = two.lease();
  ASSERT_EQ(two.fill(block, 42), "ok");
  const Buffer kept = two.commit(block);
  EXPECT_EQ(two.reader.tell("poke " + words_of(block)), "");
  EXPECT_EQ(two.reader.wait(), SIGSEGV);
  EXPECT_EQ(kept.bytes().front(), std::byte{42});
}

TEST(SharingProcess, TakesBackWhatAKilledWriterHad) {
  TwoProcesses two;
  const BlockRef committed = two.lease();
  ASSERT_EQ(two.fill(committed, 42), "ok");
  Buffer kept = two.commit(committed);
  ASSERT_EQ(two.fill(two.lease(), 43), "ok");
  EXPECT_EQ(two.host.pool->counters().uncommitted, 1u);
  two.writer.kill();
  ASSERT_TRUE(becomes_true([&] { return two.host.pool->counters().clients == 1; }));
  EXPECT_EQ(two.host.pool->counters().uncommitted, 0u);
  EXPECT_EQ(two.host.pool->counters().blocks, 1u);
  EXPECT_EQ(kept.bytes().back(), std::byte{42}) << "what it committed stays";
  ASSERT_TRUE(two.host.pool->share(committed, kReader).ok());
  EXPECT_EQ(two.reader.tell("read " + words_of(committed)), "42");
  ASSERT_TRUE(two.host.pool->release(kReader, committed).ok());
  kept = Buffer();
  EXPECT_EQ(two.host.pool->counters().slab_bytes, 0u);
  EXPECT_EQ(two.host.pool->lease(kWriter, kGroup, 64).status().code(),
            StatusCode::kFailedPrecondition);
}

TEST(SharingProcess, TakesBackWhatAKilledReaderHad) {
  TwoProcesses two;
  const BlockRef block = two.lease();
  ASSERT_EQ(two.fill(block, 42), "ok");
  Buffer kept = two.commit(block);
  ASSERT_TRUE(two.host.pool->share(block, kReader).ok());
  ASSERT_EQ(two.reader.tell("read " + words_of(block)), "42");
  kept = Buffer();
  EXPECT_EQ(two.host.pool->counters().blocks, 1u);
  two.reader.kill();
  EXPECT_TRUE(becomes_true([&] { return two.host.pool->counters().blocks == 0; }));
  EXPECT_TRUE(two.host.server->is_connected(kWriter));
}

TEST(SharingProcess, NoticesAKilledClientWhoseChildLives) {
  SharedHost host;
  PeerProcess writer(host.scratch);
  ASSERT_EQ(writer.connect(host, kWriter), "ok");
  ASSERT_TRUE(host.pool->lease(kWriter, kGroup, 64).ok());
  const pid_t child = std::stoi(writer.tell("fork"));
  ASSERT_GT(child, 0);
  writer.kill();
  EXPECT_TRUE(becomes_true([&] { return host.pool->counters().uncommitted == 0; }));
  EXPECT_EQ(::kill(child, SIGKILL), 0) << "it still has the socket";
}

TEST(SharingProcess, RefusesAReaderWithoutGrantAndAnothersBlock) {
  TwoProcesses two;
  PeerProcess stranger(two.host.scratch);
  ASSERT_EQ(stranger.connect(two.host, 3), "ok");
  const BlockRef block = two.lease();
  const std::string words = " " + words_of(block) + " ";
  EXPECT_NE(two.reader.tell("fill" + words + "1"), "ok") << "not mapped by its writer yet";
  ASSERT_EQ(two.fill(block, 42), "ok");
  const Buffer kept = two.commit(block);
  EXPECT_NE(two.reader.tell("fill" + words + "1"), "ok");
  EXPECT_EQ(stranger.tell("read" + words).rfind("not found", 0), 0u);
  EXPECT_EQ(stranger.tell("fill" + words + "1").rfind("not found", 0), 0u);
  EXPECT_EQ(kept.bytes().front(), std::byte{42});
  ASSERT_TRUE(two.host.pool->grant_read(3, kGroup).ok());
  EXPECT_EQ(stranger.tell("read" + words), "42") << "a grant counts from when it is given";
}

TEST(SharingProcess, OutlivesAServerThatIsKilledAndConnectsToTheNext) {
  const engram::testing::Scratch scratch;
  const auto socket = scratch / "socket";
  PeerProcess server(scratch);
  const std::string ticket = server.tell("serve " + socket.string());
  ASSERT_EQ(ticket.size(), 64u) << ticket;
  const auto client = SharingClient::connect(socket, engram::testing::ticket_of(ticket), {});
  ASSERT_TRUE(client.ok()) << client.status().to_string();
  std::istringstream words(server.tell("offer"));
  const BlockRef block = engram::testing::block_of(words);
  const auto read = (*client)->readable(block, 4096);
  ASSERT_TRUE(read.ok()) << read.status().to_string();
  server.kill();
  EXPECT_TRUE(becomes_true([&] { return !(*client)->is_connected(); }));
  EXPECT_EQ((*client)->readable(block, 4096).status().code(), StatusCode::kUnavailable);
  EXPECT_EQ(read->bytes().front(), std::byte{42});
  EXPECT_EQ(read->bytes().back(), std::byte{42});
  EXPECT_TRUE(std::filesystem::is_socket(socket)) << "it could not remove it";
  PeerProcess next(scratch);
  const std::string again = next.tell("serve " + socket.string());
  ASSERT_EQ(again.size(), 64u) << again;
  EXPECT_TRUE(SharingClient::connect(socket, engram::testing::ticket_of(again), {}).ok());
  PeerProcess third(scratch);
  EXPECT_EQ(third.tell("serve " + socket.string()).rfind("failed precondition", 0), 0u);
}

TEST(SharingProcess, LeavesNothingInTheFileSystemWhenItsServerStops) {
  std::filesystem::path socket;
  engram::testing::Scratch scratch;
  {
    auto pool = std::move(*SharedPool::create({}));
    SharingServer::Options options;
    options.socket = socket = scratch / "socket";
    const auto server = SharingServer::start(*pool, options);
    ASSERT_TRUE(server.ok());
    EXPECT_TRUE(std::filesystem::is_socket(socket));
    struct stat found {};
    ASSERT_EQ(::stat(socket.c_str(), &found), 0);
    EXPECT_EQ(found.st_mode & 0777, 0600u);
  }
  EXPECT_FALSE(std::filesystem::exists(socket));
}

}  // namespace
}  // namespace engram::server
