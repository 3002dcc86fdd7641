// SPDX-License-Identifier: Apache-2.0
// sharing_peer PIPE: does what the lines of a pipe say, and answers each with a line.
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>

#include "server/sharing/shared_pool.h"
#include "server/sharing/sharing_client.h"
#include "server/sharing/sharing_server.h"
#include "tests/server/sharing/block_words.h"

namespace {

using engram::Buffer;
using engram::Status;
using engram::server::BlockRef;
using engram::server::kServerItself;
using engram::server::SharedPool;
using engram::server::SharingClient;
using engram::server::SharingServer;
using engram::testing::block_of;
using engram::testing::ticket_of;
using engram::testing::words_of;

std::string told(const Status& status) {
  return status.ok() ? "ok" : status.to_string();
}

/// The value that all bytes have.
std::string value_of(const Buffer& buffer) {
  const bool is_same = std::ranges::all_of(
      buffer.bytes(), [&](std::byte one) { return one == buffer.bytes().front(); });
  return is_same ? std::to_string(std::to_integer<int>(buffer.bytes().front())) : "mixed";
}

class Peer {
 public:
  std::string obey(const std::string& line) {
    std::istringstream words(line);
    std::string command;
    words >> command;
    if (command == "connect") return connect(words);
    if (command == "fill") return fill(words);
    if (command == "read") return read(words);
    if (command == "poke") return poke(words);
    if (command == "drop") return drop();
    if (command == "serve") return serve(words);
    if (command == "offer") return offer();
    if (command == "fork") return fork_holder();
    return "unknown";
  }

 private:
  std::string connect(std::istream& words) {
    std::string socket, ticket;
    words >> socket >> ticket;
    auto client = SharingClient::connect(socket, ticket_of(ticket), {});
    if (client.ok()) client_ = std::move(*client);
    return told(client.status());
  }

  std::string fill(std::istream& words) {
    const BlockRef block = block_of(words);
    int value = 0;
    words >> value;
    const auto bytes = client_->writable(block);
    if (bytes.ok()) std::memset(bytes->data(), value, bytes->size());
    return told(bytes.status());
  }

  std::string read(std::istream& words) {
    const BlockRef block = block_of(words);
    auto buffer = client_->readable(block, block.capacity);
    if (!buffer.ok()) return told(buffer.status());
    kept_.push_back(*buffer);
    return value_of(*buffer);
  }

  std::string poke(std::istream& words) {
    const BlockRef block = block_of(words);
    const auto buffer = client_->readable(block, block.capacity);
    if (!buffer.ok()) return told(buffer.status());
    // Sanitizers would report it instead.
    ::signal(SIGSEGV, SIG_DFL);
    *const_cast<volatile std::byte*>(buffer->data()) = std::byte{1};
    return "written";
  }

  std::string drop() {
    kept_.clear();
    return std::to_string(client_->take_released().size());
  }

  /// Becomes a server, and says the ticket of client 1, who may read group 7.
  std::string serve(std::istream& words) {
    SharingServer::Options options;
    words >> options.socket;
    pool_ = std::move(*SharedPool::create({}));
    auto server = SharingServer::start(*pool_, options);
    if (!server.ok()) return told(server.status());
    server_ = std::move(*server);
    return words_of(*server_->issue_ticket(1, {7}));
  }

  /// Shares a block full of 42 with client 1.
  std::string offer() {
    const BlockRef block = *pool_->lease(kServerItself, 7, 4096);
    std::ranges::fill(*pool_->writable(block), std::byte{42});
    kept_.push_back(*pool_->commit(kServerItself, 7, block, 4096));
    const Status shared = pool_->share(block, 1);
    if (!shared.ok()) return told(shared);
    return words_of(block);
  }

  /// A child that has the connection too, and does not end.
  static std::string fork_holder() {
    const pid_t child = ::fork();
    if (child == 0)
      for (;;) ::pause();
    return std::to_string(child);
  }

  std::unique_ptr<SharingClient> client_;
  std::unique_ptr<SharedPool> pool_;
  std::unique_ptr<SharingServer> server_;
  std::vector<Buffer> kept_;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  std::ifstream commands(argv[1]);
  Peer peer;
  for (std::string line; std::getline(commands, line);) std::cout << peer.obey(line) << std::endl;
  return 0;
}
