// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>

#include "ltm/core/child.h"
#include "server/sharing/descriptor.h"
#include "server/sharing/shared_pool.h"
#include "server/sharing/sharing_client.h"
#include "server/sharing/sharing_server.h"
#include "tests/server/sharing/block_words.h"

namespace engram::testing {

/// Waits until something is so that another thread or process brings about.
inline bool becomes_true(const std::function<bool()>& condition) {
  for (int i = 0; i < 2000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return false;
}

/// A directory that is gone with this.
class Scratch {
 public:
  Scratch() {
    std::string name = (std::filesystem::temp_directory_path() / "sharing-XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  ~Scratch() { std::filesystem::remove_all(path_); }

  [[nodiscard]] std::filesystem::path operator/(const char* name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

/// A pool and its server.
struct SharedHost {
  explicit SharedHost(const server::SharedPool::Options& pool_options = {},
                      server::SharingServer::Options options = quick())
      : pool(std::move(*server::SharedPool::create(pool_options))) {
    options.socket = socket();
    auto started = server::SharingServer::start(*pool, std::move(options));
    EXPECT_TRUE(started.ok()) << started.status().to_string();
    server = std::move(*started);
  }

  static server::SharingServer::Options quick() {
    server::SharingServer::Options options;
    options.trim_interval = std::chrono::milliseconds(20);
    return options;
  }

  [[nodiscard]] std::filesystem::path socket() const { return scratch / "socket"; }

  std::unique_ptr<server::SharingClient> connect(server::ClientId client,
                                                 std::vector<server::GroupId> readable = {}) {
    const auto ticket = server->issue_ticket(client, std::move(readable));
    auto connected = server::SharingClient::connect(socket(), *ticket, {});
    EXPECT_TRUE(connected.ok()) << connected.status().to_string();
    return connected.ok() ? std::move(*connected) : nullptr;
  }

  /// A block that `writer` filled and committed.
  Buffer commit(server::SharingClient& writer, server::ClientId name, server::GroupId group,
                size_t bytes, int value, server::BlockRef* block = nullptr) {
    const auto leased = pool->lease(name, group, bytes);
    EXPECT_TRUE(leased.ok()) << leased.status().to_string();
    const auto span = writer.writable(*leased);
    EXPECT_TRUE(span.ok()) << span.status().to_string();
    if (!span.ok()) return {};
    std::fill(span->begin(), span->end(), std::byte(value));
    auto buffer = pool->commit(name, group, *leased, bytes);
    EXPECT_TRUE(buffer.ok()) << buffer.status().to_string();
    if (block != nullptr) *block = *leased;
    return buffer.value_or(Buffer());
  }

  Scratch scratch;
  std::unique_ptr<server::SharedPool> pool;
  std::unique_ptr<server::SharingServer> server;
};

/// A client in a process of its own (sharing_peer.cpp).
class PeerProcess {
 public:
  explicit PeerProcess(const Scratch& scratch) {
    static int count = 0;
    const auto pipe = scratch / ("pipe" + std::to_string(++count)).c_str();
    EXPECT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    // For both: opening waits for nobody.
    commands_ = server::Descriptor(::open(pipe.c_str(), O_RDWR | O_CLOEXEC));
    int ends[2];
    EXPECT_EQ(::pipe2(ends, O_CLOEXEC), 0);
    answers_ = server::Descriptor(ends[0]);
    const server::Descriptor writing(ends[1]);
    const auto child = start_child({ENGRAM_SHARING_PEER, pipe.string()}, {ends[1], {}});
    EXPECT_TRUE(child.ok()) << child.status().to_string();
    pid_ = child.value_or(-1);
  }
  PeerProcess(const PeerProcess&) = delete;
  PeerProcess& operator=(const PeerProcess&) = delete;
  ~PeerProcess() {
    if (pid_ > 0) kill();
  }

  /// What it answers; nothing where it died.
  std::string tell(const std::string& line) {
    const std::string whole = line + "\n";
    EXPECT_EQ(::write(commands_.get(), whole.data(), whole.size()),
              static_cast<ssize_t>(whole.size()));
    std::string answer;
    for (char next = 0; ::read(answers_.get(), &next, 1) == 1 && next != '\n';) answer += next;
    return answer;
  }

  std::string connect(SharedHost& host, server::ClientId client,
                      std::vector<server::GroupId> readable = {}) {
    const auto ticket = host.server->issue_ticket(client, std::move(readable));
    return tell("connect " + host.socket().string() + " " + words_of(*ticket));
  }

  /// The signal that ended it, zero where it ended by itself.
  int wait() {
    int status = 0;
    ::waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  }

  void kill() {
    ::kill(pid_, SIGKILL);
    wait();
  }

 private:
  pid_t pid_ = -1;
  server::Descriptor commands_;
  server::Descriptor answers_;
};

}  // namespace engram::testing
