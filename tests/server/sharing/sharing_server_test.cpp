// SPDX-License-Identifier: Apache-2.0
// Peers that mean no good, or break.
#include "server/sharing/sharing_server.h"

#include <sys/socket.h>

#include <atomic>
#include <deque>
#include <random>

#include "server/sharing/channel.h"
#include "server/sharing/listening_socket.h"
#include "tests/server/sharing/shared_host.h"

namespace engram::server {
namespace {

using engram::testing::becomes_true;
using engram::testing::SharedHost;

constexpr ClientId kClient = 1;
constexpr GroupId kGroup = 7;

Descriptor reach(const SharedHost& host) {
  auto socket = connect_socket(host.socket(), 1000);
  EXPECT_TRUE(socket.ok()) << socket.status().to_string();
  return socket.ok() ? std::move(*socket) : Descriptor();
}

/// Whether the server has closed the connection; what it said before is read over.
bool is_cut_off(const Descriptor& socket) {
  while (true) {
    const auto arrived = receive_message(socket.get(), Descriptors::kAccept);
    if (!arrived.ok()) return true;
    if (!*arrived) return false;
  }
}

void send_bytes(const Descriptor& socket, const void* bytes, size_t count) {
  [[maybe_unused]] const ssize_t sent = ::send(socket.get(), bytes, count, MSG_NOSIGNAL);
}

/// A peer that was welcomed and says what it likes.
Descriptor enter(SharedHost& host, ClientId client, std::vector<GroupId> readable = {}) {
  Descriptor socket = reach(host);
  Message hello;
  hello.kind = Message::Kind::kHello;
  hello.ticket = *host.server->issue_ticket(client, std::move(readable));
  EXPECT_TRUE(send_message(socket.get(), hello).ok());
  const auto welcome = receive_message(socket.get(), Descriptors::kAccept);
  EXPECT_TRUE(welcome.ok() && *welcome && status_code((*welcome)->message) == StatusCode::kOk);
  return socket;
}

/// The server still does what it should, for others.
void expect_works(SharedHost& host) {
  static std::atomic<ClientId> next{1000};
  const ClientId name = ++next;
  const auto client = host.connect(name);
  ASSERT_NE(client, nullptr);
  EXPECT_EQ(host.commit(*client, name, kGroup, 100, 9).bytes().front(), std::byte{9});
}

TEST(SharingServer, TellsWhenAClientIsGone) {
  auto options = SharedHost::quick();
  std::atomic<ClientId> closed{0};
  options.on_closed = [&](ClientId client) { closed = client; };
  SharedHost host({}, options);
  auto client = host.connect(kClient);
  EXPECT_TRUE(host.server->is_connected(kClient));
  ASSERT_TRUE(host.pool->lease(kClient, kGroup, 64).ok());
  client.reset();
  EXPECT_TRUE(becomes_true([&] { return closed == kClient; }));
  EXPECT_FALSE(host.server->is_connected(kClient));
  EXPECT_EQ(host.pool->counters().blocks, 0u);
  EXPECT_EQ(host.server->counters().cut_off, 0u);
  client = host.connect(kClient);
  EXPECT_TRUE(client->is_connected()) << "its name is free again";
}

TEST(SharingServer, DisconnectsWhomItIsToldTo) {
  SharedHost host;
  const auto client = host.connect(kClient);
  host.server->disconnect(99);
  EXPECT_TRUE(client->is_connected());
  host.server->disconnect(kClient);
  EXPECT_TRUE(becomes_true([&] { return !client->is_connected(); }));
  EXPECT_TRUE(becomes_true([&] { return host.pool->counters().clients == 0; }));
}

TEST(SharingServer, CutsOffAHandshakeOfOtherBytes) {
  SharedHost host;
  std::mt19937 random(1);
  for (const size_t bytes : {1, 32, 63, 64, 65, 4096, 65536}) {
    const Descriptor peer = reach(host);
    std::vector<unsigned char> garbage(bytes);
    for (auto& byte : garbage) byte = static_cast<unsigned char>(random());
    send_bytes(peer, garbage.data(), garbage.size());
    EXPECT_TRUE(is_cut_off(peer)) << bytes;
  }
  const Descriptor silent = reach(host);
  send_bytes(silent, "", 0);
  EXPECT_TRUE(is_cut_off(silent));
  EXPECT_EQ(host.server->counters().refused, 8u);
  expect_works(host);
}

TEST(SharingServer, AnswersNothingBeforeTheTicket) {
  SharedHost host;
  ASSERT_TRUE(host.pool->lease(kServerItself, kGroup, 64).ok());
  const Descriptor peer = reach(host);
  Message message;
  message.kind = Message::Kind::kOpenSlab;
  message.slab = 1;
  ASSERT_TRUE(send_message(peer.get(), message).ok());
  const auto arrived = receive_message(peer.get(), Descriptors::kAccept);
  ASSERT_TRUE(arrived.ok() && *arrived);
  EXPECT_FALSE((*arrived)->descriptor.is_open());
  EXPECT_NE(status_code((*arrived)->message), StatusCode::kOk);
  EXPECT_TRUE(is_cut_off(peer));
}

TEST(SharingServer, CutsOffWhoIsSilent) {
  auto options = SharedHost::quick();
  options.handshake_timeout = std::chrono::milliseconds(50);
  SharedHost host({}, options);
  const Descriptor peer = reach(host);
  EXPECT_TRUE(is_cut_off(peer));
  expect_works(host);
}

TEST(SharingServer, CutsOffAClientThatSaysAnythingElse) {
  SharedHost host;
  for (const auto kind : {Message::Kind::kHello, Message::Kind::kSlab, Message::Kind(0),
                          Message::Kind(1000), Message::Kind::kSlabGone}) {
    const Descriptor peer = enter(host, kClient);
    Message message;
    message.kind = kind;
    ASSERT_TRUE(send_message(peer.get(), message).ok());
    EXPECT_TRUE(is_cut_off(peer));
    EXPECT_TRUE(becomes_true([&] { return host.pool->counters().clients == 0; }));
  }
  EXPECT_EQ(host.server->counters().cut_off, 5u);
}

TEST(SharingServer, RefusesSlabsThatAreNotTheClients) {
  SharedHost host;
  const auto writer = host.connect(2);
  BlockRef block;
  const Buffer kept = host.commit(*writer, 2, kGroup, 64, 1, &block);
  const Descriptor peer = enter(host, kClient);
  for (const SlabId slab : {SlabId{0}, block.slab, block.slab + 1, ~SlabId{0}})
    for (const auto kind : {Message::Kind::kOpenSlab, Message::Kind::kSlabMapped}) {
      Message message;
      message.kind = kind;
      message.slab = slab;
      ASSERT_TRUE(send_message(peer.get(), message).ok());
      const auto arrived = receive_message(peer.get(), Descriptors::kAccept);
      ASSERT_TRUE(arrived.ok() && *arrived);
      EXPECT_EQ(status_code((*arrived)->message), StatusCode::kNotFound);
      EXPECT_FALSE((*arrived)->descriptor.is_open());
    }
}

TEST(SharingServer, CutsOffWhoAsksAndDoesNotRead) {
  SharedHost host;
  const Descriptor peer = enter(host, kClient);
  Message message;
  message.kind = Message::Kind::kOpenSlab;
  message.slab = 1;
  size_t sent = 0;
  while (sent < 1'000'000 && send_message(peer.get(), message).ok()) ++sent;
  EXPECT_LT(sent, 1'000'000u);
  EXPECT_TRUE(becomes_true([&] { return host.pool->counters().clients == 0; }));
  EXPECT_EQ(host.server->counters().cut_off, 1u);
  expect_works(host);
}

TEST(SharingServer, TakesNoDescriptorsFromItsClients) {
  SharedHost host;
  const Descriptor peer = enter(host, kClient);
  int ends[2];
  ASSERT_EQ(::pipe2(ends, O_CLOEXEC | O_NONBLOCK), 0);
  const Descriptor reading(ends[0]);
  {
    const Descriptor writing(ends[1]);
    Message message;
    message.kind = Message::Kind::kOpenSlab;
    ASSERT_TRUE(send_message(peer.get(), message, writing.get()).ok());
    ASSERT_TRUE(receive_message(peer.get(), Descriptors::kAccept).ok());
  }
  char byte = 0;
  EXPECT_EQ(::read(reading.get(), &byte, 1), 0) << "nobody has the other end";
}

TEST(SharingServer, ServesClientsDuringAFloodOfConnections) {
  auto options = SharedHost::quick();
  options.max_pending = 4;
  SharedHost host({}, options);
  const auto before = host.connect(kClient);
  std::atomic<bool> is_over{false};
  std::jthread flood([&] {
    std::deque<Descriptor> held;
    while (!is_over) {
      auto socket = connect_socket(host.socket(), 10);
      if (socket.ok()) held.push_back(std::move(*socket));
      if (held.size() > 200) held.pop_front();
    }
  });
  ASSERT_TRUE(becomes_true([&] { return host.server->counters().refused > 500; }));
  EXPECT_EQ(host.commit(*before, kClient, kGroup, 100, 9).bytes().front(), std::byte{9});
  EXPECT_TRUE(becomes_true([&] {
    const Ticket ticket = *host.server->issue_ticket(2);
    return SharingClient::connect(host.socket(), ticket, {}).ok();
  })) << "who comes meanwhile gets in";
  is_over = true;
}

TEST(SharingServer, TakesNoMoreClientsThanItMay) {
  auto options = SharedHost::quick();
  options.max_connections = 2;
  SharedHost host({}, options);
  auto first = host.connect(1);
  const auto second = host.connect(2);
  const Ticket ticket = *host.server->issue_ticket(3);
  EXPECT_EQ(SharingClient::connect(host.socket(), ticket, {}).status().code(),
            StatusCode::kResourceExhausted);
  first.reset();
  ASSERT_TRUE(becomes_true([&] { return !host.server->is_connected(1); }));
  EXPECT_NE(host.connect(3), nullptr);
}

TEST(SharingServer, RefusesOldTickets) {
  auto pool = std::move(*SharedPool::create({}));
  const engram::testing::Scratch scratch;
  std::atomic<int64_t> seconds{1000};
  SharingServer::Options options;
  options.socket = scratch / "socket";
  const auto server = SharingServer::start(
      *pool, options, [&] { return Time(std::chrono::seconds(seconds.load())); });
  ASSERT_TRUE(server.ok());
  const Ticket ticket = *(*server)->issue_ticket(kClient);
  seconds += 31;
  EXPECT_EQ(SharingClient::connect(options.socket, ticket, {}).status().code(),
            StatusCode::kNotFound);
  EXPECT_EQ((*server)->issue_ticket(kServerItself).status().code(), StatusCode::kInvalidArgument);
}

TEST(SharingServer, RefusesOptionsThatCannotBe) {
  auto pool = std::move(*SharedPool::create({}));
  SharingServer::Options options;
  EXPECT_EQ(SharingServer::start(*pool, options).status().code(), StatusCode::kInvalidArgument);
  options.socket = "somewhere";
  options.mode = 0666;
  EXPECT_EQ(SharingServer::start(*pool, options).status().code(), StatusCode::kInvalidArgument);
  options.mode = 0600;
  options.max_pending = 0;
  EXPECT_EQ(SharingServer::start(*pool, options).status().code(), StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace engram::server
