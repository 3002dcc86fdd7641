// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <grpcpp/create_channel.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <atomic>
#include <fstream>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "server/client/client_stream.h"
#include "server/wire/byte_message.h"
#include "tests/ltm/expect_status.h"
#include "tests/server/access/secret_file.h"
#include "tests/server/robot/running_server.h"

namespace engram::testing {

inline constexpr const char* kCommits = "/engram.v1.MemoryServer/Commit";
inline constexpr const char* kQueries = "/engram.v1.MemoryServer/Query";
inline constexpr const char* kSubscriptions = "/engram.v1.MemoryServer/Subscribe";

/// A sanitizer remembers every byte several times.
#ifdef __SANITIZE_THREAD__
inline constexpr size_t kMiB = size_t{6} << 20;
#else
inline constexpr size_t kMiB = size_t{1} << 20;
#endif

/// What this process has in RAM.
inline size_t resident_bytes() {
  std::ifstream file("/proc/self/statm");
  size_t all = 0;
  size_t resident = 0;
  file >> all >> resident;
  return resident * static_cast<size_t>(::sysconf(_SC_PAGESIZE));
}

/// A connection that may say anything.
class RawSocket {
 public:
  explicit RawSocket(const std::string& path) : socket_(::socket(AF_UNIX, SOCK_STREAM, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof(address.sun_path) - 1);
    EXPECT_EQ(::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  }
  /// To a port of this machine.
  explicit RawSocket(int port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  }
  ~RawSocket() { ::close(socket_); }
  RawSocket(const RawSocket&) = delete;
  RawSocket& operator=(const RawSocket&) = delete;

  /// False where the server has hung up, or has read nothing for so many seconds.
  bool say(const std::string& bytes, int seconds = 1) {
    const timeval patience{seconds, 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof(patience));
    size_t sent = 0;
    while (sent < bytes.size()) {
      const ssize_t count = ::send(socket_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
      if (count <= 0) return false;
      sent += static_cast<size_t>(count);
    }
    return true;
  }

 private:
  int socket_;
};

inline const std::string kPreface = "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n";

/// An HTTP/2 frame.
inline std::string frame(uint8_t type, uint8_t flags, uint32_t stream, const std::string& payload) {
  const auto size = static_cast<uint32_t>(payload.size());
  std::string made;
  for (const int shift : {16, 8, 0}) made += static_cast<char>(size >> shift & 0xff);
  made += static_cast<char>(type);
  made += static_cast<char>(flags);
  for (const int shift : {24, 16, 8, 0}) made += static_cast<char>(stream >> shift & 0xff);
  return made + payload;
}

inline std::string random_bytes(std::mt19937& random, size_t count) {
  std::string made(count, '\0');
  for (char& byte : made) byte = static_cast<char>(random());
  return made;
}

/// A server, and somebody who uses it all along.
class HostileClient : public ::testing::Test {
 protected:
  void SetUp() override { running.with_store(); }

  void TearDown() override {
    if (!running.server) return;
    expect_served();
    user_.request_stop();
    if (user_.joinable()) user_.join();
    EXPECT_GT(served_, 0);
  }

  void start() {
    running.start();
    good_ = running.client({.token = good_token});
    user_ = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        serve_once();
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
      }
    });
  }

  void serve_once() {
    const int64_t at = ++last_;
    const Status status = good_->commit(RunningServer::commit("Good/b/c/d", at));
    EXPECT_OK(status);
    const auto found =
        good_->query(*ltm::Query::parse(fmt::format("Good/b/c/d @ at-or-before:{}", at)));
    EXPECT_OK(found);
    if (status.ok() && found.ok()) ++served_;
  }

  /// Somebody who comes now is served within seconds.
  void expect_served() {
    const auto begun = steady_now();
    const auto newcomer = running.client({.token = good_token});
    EXPECT_OK(newcomer->commit(RunningServer::commit("Good/b/c/new", ++last_)));
    EXPECT_OK(newcomer->query(*ltm::Query::parse("Good/b/c/new")));
    EXPECT_LT(steady_now() - begun, std::chrono::seconds(5));
  }

  [[nodiscard]] std::shared_ptr<grpc::Channel> channel() const {
    grpc::ChannelArguments arguments;
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    arguments.SetMaxSendMessageSize(-1);
    return grpc::CreateCustomChannel(running.endpoint(), grpc::InsecureChannelCredentials(),
                                     arguments);
  }

  [[nodiscard]] std::string socket_path() const { return running.endpoint().substr(5); }

  /// A figure of the server.
  double metric(const std::string& name) {
    const auto text = good_->metrics();
    EXPECT_OK(text);
    const auto at = text->find("\n" + name + " ");
    return at == std::string::npos ? -1 : std::stod(text->substr(at + name.size() + 2));
  }

  /// Waits up to 2 s until a figure is `value` or more.
  bool reaches(const std::string& name, double value) {
    for (int i = 0; i < 40 && metric(name) < value; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    return metric(name) >= value;
  }

  void write_tokens(const std::string& rest_of_bad) {
    running.options.tokens = write_secret(
        running.folder / "tokens.yaml",
        fmt::format("tokens:\n"
                    "  - name: good\n    token_sha256: {}\n    role: write\n    memories: all\n"
                    "  - name: bad\n    token_sha256: {}\n    role: write\n    memories: [Bad]\n{}",
                    server::to_hex(server::hash_token(good_token)),
                    server::to_hex(server::hash_token(bad_token)), rest_of_bad));
  }

  RunningServer running;
  std::string good_token;
  const std::string bad_token = std::string(40, 'b');

 private:
  std::unique_ptr<server::MemoryClient> good_;
  std::atomic<int64_t> last_{0};
  std::atomic<int> served_{0};
  std::jthread user_;
};

/// Streams of raw messages, and how they ended.
class RawStreams {
 public:
  ~RawStreams() {
    for (const auto& stream : all_) stream->cancel();
    all_.clear();
    streams_.wait();
  }

  server::ClientStream& open(const std::shared_ptr<grpc::Channel>& channel,
                             const std::string& method, const std::string& token = {}) {
    all_.push_back(server::ClientStream::open(channel, method, token, streams_,
                                              {[this](grpc::ByteBuffer& /*reply*/) { ++replies; },
                                               [this](const Status& status) {
                                                 if (status.code() == StatusCode::kInvalidArgument)
                                                   ++refused;
                                                 if (status.code() ==
                                                     StatusCode::kResourceExhausted)
                                                   ++exhausted;
                                                 ++ended;
                                               }}));
    return *all_.back();
  }

  /// Waits until `count` reaches `needed`.
  static bool reaches(const std::atomic<int>& count, int needed) {
    for (int i = 0; i < 2000 && count < needed; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return count >= needed;
  }

  std::atomic<int> replies{0};
  std::atomic<int> ended{0};
  std::atomic<int> refused{0};    ///< Ended with kInvalidArgument.
  std::atomic<int> exhausted{0};  ///< With kResourceExhausted.

 private:
  server::OpenStreams streams_;
  std::vector<std::shared_ptr<server::ClientStream>> all_;
};

inline grpc::ByteBuffer raw(const std::string& bytes) {
  const grpc::Slice slice(bytes);
  return {&slice, 1};
}

}  // namespace engram::testing
