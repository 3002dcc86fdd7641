// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/connection_guard.h"

#include <arpa/inet.h>
#include <dirent.h>
#include <fmt/format.h>
#include <grpc/grpc.h>
#include <grpc/support/alloc.h>
#include <netinet/in.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <chrono>
#include <cstring>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <utility>

#include "ltm/core/free_memory.h"
#include "ltm/core/log.h"
#include "ltm/core/mutex.h"
#include "ltm/idf/base64.h"
#include "server/access/rate_limit.h"

namespace engram::server {

namespace {

using Json = nlohmann::json;

constexpr auto kInterval = std::chrono::milliseconds(50);
/// Connections are looked at so often even if few calls were started.
constexpr int kIntervalsOfQuiet = 20;
/// Fewer calls in an interval than this need no look at each connection.
constexpr int64_t kFewCalls = 50;

/// What gRPC tells of something; null where it tells nothing.
Json told(char* text) {
  if (text == nullptr) return {};
  Json json = Json::parse(text, nullptr, false);
  ::gpr_free(text);
  return json.is_discarded() ? Json() : json;
}

/// Numbers of 64 bits are texts in the JSON of protocol buffers. Zero is left out.
int64_t number(const Json& json, const char* path) {
  const Json::json_pointer pointer(path);
  if (!json.is_object() || !json.contains(pointer)) return 0;
  const Json& found = json.at(pointer);
  if (found.is_number_integer()) return found.get<int64_t>();
  if (!found.is_string()) return 0;
  const auto& text = found.get_ref<const std::string&>();
  int64_t value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

/// Where a connection comes from, as text that is alike for IPv4 and IPv4 in IPv6:
/// "7f000001:39290".
std::string text_of(std::string_view address, int port) {
  constexpr std::string_view kMapped("\0\0\0\0\0\0\0\0\0\0\xff\xff", 12);
  if (address.size() == 16 && address.starts_with(kMapped)) address.remove_prefix(kMapped.size());
  std::string text;
  for (const char byte : address) text += fmt::format("{:02x}", static_cast<uint8_t>(byte));
  return fmt::format("{}:{}", text, port);
}

/// The peer of a connection as gRPC tells it; nothing for those on a Unix socket.
std::optional<std::string> peer_of(const Json& socket) {
  const Json::json_pointer pointer("/socket/remote/tcpip_address");
  if (!socket.is_object() || !socket.contains(pointer)) return std::nullopt;
  const Json& address = socket.at(pointer);
  const auto bytes = idf::from_base64(address.value("ip_address", std::string()));
  if (!bytes) return std::nullopt;
  return text_of({reinterpret_cast<const char*>(bytes->data()), bytes->size()},
                 static_cast<int>(address.value("port", 0)));
}

/// The same of a socket of this process.
std::optional<std::string> peer_of(int socket) {
  sockaddr_storage peer{};
  socklen_t size = sizeof(peer);
  if (::getpeername(socket, reinterpret_cast<sockaddr*>(&peer), &size) != 0) return std::nullopt;
  if (peer.ss_family == AF_INET) {
    sockaddr_in v4{};
    std::memcpy(&v4, &peer, sizeof(v4));
    return text_of({reinterpret_cast<const char*>(&v4.sin_addr), sizeof(v4.sin_addr)},
                   ntohs(v4.sin_port));
  }
  if (peer.ss_family != AF_INET6) return std::nullopt;
  sockaddr_in6 v6{};
  std::memcpy(&v6, &peer, sizeof(v6));
  return text_of({reinterpret_cast<const char*>(&v6.sin6_addr), sizeof(v6.sin6_addr)},
                 ntohs(v6.sin6_port));
}

/// The file of the Unix socket that a connection came to.
std::string path_of(const Json& socket) {
  const Json::json_pointer pointer("/socket/local/uds_address/filename");
  const bool is_told = socket.is_object() && socket.contains(pointer);
  return is_told && socket.at(pointer).is_string() ? socket.at(pointer).get<std::string>() : "";
}

/// Bytes that came on a connection to the Unix socket at `path` and were not read; nothing for
/// others.
std::optional<int> unread_on_unix(int socket, const std::string& path) {
  sockaddr_un own{};
  socklen_t size = sizeof(own);
  int listens = 1, unread = 0;
  socklen_t listens_size = sizeof(listens);
  const bool is_named = ::getsockname(socket, reinterpret_cast<sockaddr*>(&own), &size) == 0 &&
                        own.sun_family == AF_UNIX && path == own.sun_path;
  if (!is_named || ::getsockopt(socket, SOL_SOCKET, SO_ACCEPTCONN, &listens, &listens_size) != 0 ||
      listens != 0 || ::ioctl(socket, FIONREAD, &unread) != 0)
    return std::nullopt;
  return unread;
}

void for_each_descriptor(const std::function<void(int)>& visit) {
  DIR* folder = ::opendir("/proc/self/fd");
  if (folder == nullptr) return;
  while (const dirent* entry = ::readdir(folder)) {
    const std::string_view name = entry->d_name;
    int descriptor = -1;
    std::from_chars(name.data(), name.data() + name.size(), descriptor);
    if (descriptor > STDERR_FILENO) visit(descriptor);
  }
  ::closedir(folder);
}

/// Shuts down the connection with a peer; gRPC then sees its end, and closes it.
bool shut_down(const std::string& peer) {
  bool is_done = false;
  for_each_descriptor([&](int descriptor) {
    if (peer_of(descriptor) != peer) return;
    is_done = ::shutdown(descriptor, SHUT_RDWR) == 0 || is_done;
    // The peer may still send until gRPC closes it, which can take a minute; a reset ends that.
    sockaddr none{};
    none.sa_family = AF_UNSPEC;
    is_done = ::connect(descriptor, &none, sizeof(none)) == 0 || is_done;
  });
  return is_done;
}

/// The same for the connection to a Unix socket with the most unread bytes, if any has some.
bool shut_down_unread(const std::string& path) {
  int max_unread = 0, found = -1;
  for_each_descriptor([&](int descriptor) {
    const auto unread = unread_on_unix(descriptor, path);
    if (!unread || *unread <= max_unread) return;
    max_unread = *unread;
    found = descriptor;
  });
  return found >= 0 && ::shutdown(found, SHUT_RDWR) == 0;
}

/// What is known of a connection.
struct Connection {
  /// Streams that it opened and that came to no end, as far as they were counted.
  int64_t streams = 0;
  bool is_cut = false;
  RateLimit limit{static_cast<double>(ConnectionGuard::kStreamsPerSecond), steady_now()};

  /// False where more came than may.
  bool count(int64_t streams_now) {
    const int64_t more = streams_now - std::exchange(streams, streams_now);
    return more <= 0 || limit.take(steady_now(), static_cast<double>(more));
  }
};

/// Looks at the connections of all servers of the process.
class Watch {
 public:
  /// Returns the number of connections that were cut off.
  uint64_t look() {
    uint64_t cut = 0;
    const Json servers = told(::grpc_channelz_get_servers(0));
    if (!servers.is_object() || !servers.contains("server")) return 0;
    int64_t started = 0;
    for (const Json& server : servers["server"]) started += number(server, "/data/callsStarted");
    const bool is_quiet = started - started_ < kFewCalls && ++quiet_ < kIntervalsOfQuiet;
    started_ = started;
    if (is_quiet) return 0;
    quiet_ = 0;
    std::set<int64_t> seen;
    for (const Json& server : servers["server"])
      cut += look_at(number(server, "/ref/serverId"), seen);
    std::erase_if(connections_, [&seen](const auto& one) { return !seen.contains(one.first); });
    return cut;
  }

 private:
  uint64_t look_at(int64_t server, std::set<int64_t>& seen) {
    uint64_t cut = 0;
    const Json sockets = told(::grpc_channelz_get_server_sockets(server, 0, 0));
    if (!sockets.is_object() || !sockets.contains("socketRef")) return 0;
    for (const Json& reference : sockets["socketRef"]) {
      const int64_t id = number(reference, "/socketId");
      seen.insert(id);
      const Json socket = told(::grpc_channelz_get_socket(id));
      const int64_t streams = number(socket, "/socket/data/streamsStarted") -
                              number(socket, "/socket/data/streamsSucceeded");
      Connection& connection = connections_[id];
      if (connection.count(streams)) continue;
      const auto peer = peer_of(socket);
      if (!(peer ? shut_down(*peer) : shut_down_unread(path_of(socket)))) continue;
      // What had come before may open more, and the wrong one of a Unix socket may have been taken.
      if (std::exchange(connection.is_cut, true)) continue;
      ++cut;
      log::warning("a connection {} was cut off: of the streams that it opened, {} came to no end",
                   peer ? "from " + reference.value("name", *peer) : "on a Unix socket", streams);
    }
    return cut;
  }

  int64_t started_ = 0;  ///< Calls of all servers.
  int quiet_ = 0;
  std::map<int64_t, Connection> connections_;  ///< By gRPC's number of the socket.
};

/// Gives back to the system what connections left, which gRPC frees, but the allocator keeps. Looks
/// where RAM has grown, so that those that come one after the other take no more than one alone,
/// and else seldom: a look takes milliseconds where much is free.
class FreedMemory {
 public:
  void look() {
    constexpr int kIntervalsBetween = 200;
    constexpr uint64_t kMaxFreed = uint64_t{64} << 20;
    if (--until_ > 0 && anonymous_ram() < known_ + kMaxFreed) return;
    until_ = kIntervalsBetween;
    give_back_memory_above(kMaxFreed);
    known_ = anonymous_ram();
  }

 private:
  uint64_t known_ = 0;
  int until_ = 0;
};

}  // namespace

struct ConnectionGuard::State {
  std::atomic<uint64_t> cut = 0;
  Mutex mutex;
  ConditionVariable stopped;
  bool is_stopped ENGRAM_GUARDED_BY(mutex) = false;
  std::thread thread;

  /// True once it is to stop.
  bool wait() {
    const MutexLock lock(mutex);
    return stopped.wait_for(mutex, kInterval,
                            [this]() ENGRAM_REQUIRES(mutex) { return is_stopped; });
  }

  void run() {
    // The streams of a connection are gone some time after it.
    constexpr int kIntervalsUntilGone = 20, kTimes = 3;
    Watch watch;
    FreedMemory freed;
    int until_memory = 0;
    while (!wait()) {
      const uint64_t cut_now = watch.look();
      cut += cut_now;
      if (cut_now > 0) until_memory = kTimes * kIntervalsUntilGone;
      if (until_memory > 0 && --until_memory % kIntervalsUntilGone == 0) give_back_memory();
      freed.look();
    }
  }
};

std::shared_ptr<ConnectionGuard> ConnectionGuard::of_process() {
  static Mutex mutex;
  static std::weak_ptr<ConnectionGuard> guard ENGRAM_GUARDED_BY(mutex);
  const MutexLock lock(mutex);
  std::shared_ptr<ConnectionGuard> found = guard.lock();
  if (!found) {
    found = std::shared_ptr<ConnectionGuard>(new ConnectionGuard());
    guard = found;
  }
  return found;
}

ConnectionGuard::ConnectionGuard() : state_(std::make_unique<State>()) {
  state_->thread = std::thread([state = state_.get()] { state->run(); });
}

ConnectionGuard::~ConnectionGuard() {
  {
    const MutexLock lock(state_->mutex);
    state_->is_stopped = true;
  }
  state_->stopped.notify_all();
  state_->thread.join();
}

uint64_t ConnectionGuard::cut() const {
  return state_->cut;
}

}  // namespace engram::server
