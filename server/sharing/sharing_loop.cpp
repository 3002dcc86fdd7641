// SPDX-License-Identifier: Apache-2.0
#include "server/sharing/sharing_loop.h"

#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/syscall.h>

#include <algorithm>
#include <array>

#include "ltm/core/log.h"

namespace engram::server {

namespace {

/// The odd event of the listening socket's key, which has no process and thus leaves it free.
constexpr uint64_t kWake = 1;
constexpr int kAcceptedAtOnce = 16;

std::optional<ucred> peer_of(const Descriptor& socket) {
  ucred peer{};
  socklen_t size = sizeof(peer);
  if (::getsockopt(socket.get(), SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0) return std::nullopt;
  return peer;
}

Message answer(Message::Kind kind, SlabId slab, const Status& status) {
  Message message;
  message.kind = kind;
  message.slab = slab;
  message.status = static_cast<uint32_t>(status.code());
  return message;
}

}  // namespace

SharingServer::Loop::~Loop() {
  thread_.request_stop();
  const uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = ::write(wake_.get(), &one, sizeof(one));
  if (thread_.joinable()) thread_.join();
}

Status SharingServer::Loop::start() {
  ENGRAM_RETURN_IF_ERROR(watch(listening_.get(), kListening));
  ENGRAM_RETURN_IF_ERROR(watch(wake_.get(), kWake));
  next_trim_ = clock_() + options_.trim_interval;
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  return {};
}

Result<Ticket> SharingServer::Loop::issue_ticket(ClientId client, std::vector<GroupId> readable) {
  if (client == kServerItself)
    return invalid_argument("client {}: is the server itself, needs another name", client);
  return tickets_.issue({client, std::move(readable)}, clock_());
}

bool SharingServer::Loop::is_connected(ClientId client) const {
  const MutexLock lock(mutex_);
  return sockets_.contains(client);
}

void SharingServer::Loop::disconnect(ClientId client) {
  const MutexLock lock(mutex_);
  const auto found = sockets_.find(client);
  if (found != sockets_.end()) ::shutdown(found->second, SHUT_RDWR);
}

SharingCounters SharingServer::Loop::counters() const {
  const MutexLock lock(mutex_);
  return {sockets_.size(), accepted_, welcomed_, refused_, cut_off_};
}

Status SharingServer::Loop::watch(int fd, uint64_t event) {
  epoll_event wanted{};
  wanted.events = EPOLLIN;
  wanted.data.u64 = event;
  if (::epoll_ctl(events_.get(), EPOLL_CTL_ADD, fd, &wanted) != 0)
    return system_status("sharing: cannot watch");
  return {};
}

int SharingServer::Loop::wait_ms() const {
  Time next = next_trim_;
  if (!pending_.empty()) next = std::min(next, pending_.front().deadline);
  const auto wait = std::chrono::ceil<std::chrono::milliseconds>(next - clock_());
  // Bounded, so that a clock that is set back cannot delay the loop for long.
  return static_cast<int>(std::clamp<int64_t>(wait.count(), 0, 1000));
}

void SharingServer::Loop::run(const std::stop_token& stop) {
  std::array<epoll_event, 32> events;
  while (!stop.stop_requested()) {
    const int count =
        ::epoll_wait(events_.get(), events.data(), static_cast<int>(events.size()), wait_ms());
    bool has_new = false;
    for (int i = 0; i < count; ++i) {
      const uint64_t event = events[static_cast<size_t>(i)].data.u64;
      const Key key = event / 2;
      has_new = has_new || event == kListening;
      const auto found = connections_.find(key);
      // An earlier event of this round closed it, or it is no connection.
      if (found == connections_.end()) continue;
      const bool has_ended = event % 2 == 1;
      const Status status =
          has_ended ? unavailable("its process ended") : serve(key, found->second);
      if (status.ok()) continue;
      log::debug("sharing: client {}: {}", found->second.client, status.to_string());
      const bool is_gone = status.code() == StatusCode::kUnavailable;
      if (found->second.client == kServerItself) {
        ++refused_;
      } else if (!is_gone) {
        ++cut_off_;
      }
      close(key);
    }
    // Connected clients are served before new ones are accepted.
    if (has_new) accept_peers();
    drop_late();
    tell_gone();
  }
  while (!connections_.empty()) close(connections_.begin()->first);
}

void SharingServer::Loop::accept_peers() {
  for (int i = 0; i < kAcceptedAtOnce; ++i) {
    Descriptor socket(::accept4(listening_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
    if (socket.is_open()) {
      ++accepted_;
      accept_peer(std::move(socket));
      continue;
    }
    if (errno != EMFILE && errno != ENFILE && errno != ENOBUFS && errno != ENOMEM) return;
    // The waiting peer would wake the loop again and again, so the socket is not watched until the
    // next trim.
    log::warning("sharing: no descriptors left for new connections");
    ::epoll_ctl(events_.get(), EPOLL_CTL_DEL, listening_.get(), nullptr);
    is_listening_ = false;
    return;
  }
}

void SharingServer::Loop::accept_peer(Descriptor socket) {
  const auto peer = peer_of(socket);
  const bool is_known =
      peer && (peer->uid == ::geteuid() ||
               std::ranges::find(options_.other_uids, peer->uid) != options_.other_uids.end());
  const Key key = ++last_key_;
  if (!is_known || !watch(socket.get(), 2 * key).ok()) {
    ++refused_;
    return;
  }
  if (pending_.size() >= options_.max_pending) drop_pending(pending_.front());
  connections_[key].socket = std::move(socket);
  pending_.push_back({key, clock_() + options_.handshake_timeout});
}

void SharingServer::Loop::drop_pending(const Pending& pending) {
  ++refused_;
  close(pending.key);
}

void SharingServer::Loop::drop_late() {
  const Time now = clock_();
  while (!pending_.empty() && pending_.front().deadline <= now) drop_pending(pending_.front());
}

Status SharingServer::Loop::serve(Key key, Connection& connection) {
  ENGRAM_ASSIGN_OR_RETURN(auto arrived,
                          receive_message(connection.socket.get(), Descriptors::kRefuse));
  if (!arrived) return {};
  const Message& message = arrived->message;
  if (connection.client == kServerItself) return welcome(key, connection, message);
  switch (message.kind) {
    case Message::Kind::kOpenSlab:
      return give_slab(connection, message.slab);
    case Message::Kind::kSlabMapped:
      return send_message(connection.socket.get(),
                          answer(Message::Kind::kSlabSealed, message.slab,
                                 pool_.seal(connection.client, message.slab)));
    default:
      break;
  }
  return data_loss("found a message of kind {}, needs one of a client",
                   static_cast<uint32_t>(message.kind));
}

Status SharingServer::Loop::welcome(Key key, Connection& connection, const Message& hello) {
  const auto admit = [&]() -> Status {
    if (hello.kind != Message::Kind::kHello)
      return data_loss("found a message of kind {}, needs a ticket",
                       static_cast<uint32_t>(hello.kind));
    const auto holder = tickets_.redeem(hello.ticket, clock_());
    if (!holder) return not_found("its ticket was not issued, was used, or is too old");
    if (connections_.size() - pending_.size() >= options_.max_connections)
      return resource_exhausted("{} clients are connected", options_.max_connections);
    ENGRAM_RETURN_IF_ERROR(pool_.add_client(holder->client));
    connection.client = holder->client;
    for (const GroupId group : holder->readable)
      ENGRAM_RETURN_IF_ERROR(pool_.grant_read(holder->client, group));
    return {};
  };
  const Status admitted = admit();
  if (admitted.ok()) {
    std::erase_if(pending_, [key](const Pending& one) { return one.key == key; });
    watch_process(key, connection);
    const MutexLock lock(mutex_);
    sockets_[connection.client] = connection.socket.get();
    ++welcomed_;
  }
  const Status told =
      send_message(connection.socket.get(), answer(Message::Kind::kWelcome, 0, admitted));
  return admitted.ok() ? told : admitted;
}

void SharingServer::Loop::watch_process(Key key, Connection& connection) {
  // A child of the client may keep its socket open after the client has ended, so the process is
  // watched too. If that is impossible, the socket must suffice.
  const auto peer = peer_of(connection.socket);
  if (!peer || peer->pid <= 0) return;
  // Called as a system call, because glibc 2.36 declares pidfd_open for C only.
  connection.process = Descriptor(static_cast<int>(::syscall(SYS_pidfd_open, peer->pid, 0)));
  if (!connection.process.is_open()) return;
  if (const Status status = watch(connection.process.get(), 2 * key + 1); !status.ok())
    log::debug("sharing: client {}: {}", connection.client, status.to_string());
}

Status SharingServer::Loop::give_slab(Connection& connection, SlabId slab) {
  auto opened = pool_.open_slab(connection.client, slab);
  Message message = answer(Message::Kind::kSlab, slab, opened.status());
  if (!opened.ok()) return send_message(connection.socket.get(), message);
  message.bytes = opened->bytes;
  message.is_writer = opened->is_writer ? 1 : 0;
  connection.given.insert(slab);
  return send_message(connection.socket.get(), message, opened->memory.get());
}

void SharingServer::Loop::close(Key key) {
  const auto found = connections_.find(key);
  if (found == connections_.end()) return;
  const ClientId client = found->second.client;
  std::erase_if(pending_, [key](const Pending& one) { return one.key == key; });
  if (client != kServerItself) {
    const MutexLock lock(mutex_);
    sockets_.erase(client);
  }
  // Closing also ends the watch, since no other process holds this descriptor.
  connections_.erase(found);
  if (client == kServerItself) return;
  pool_.remove_client(client);
  if (options_.on_closed) options_.on_closed(client);
}

void SharingServer::Loop::tell_gone() {
  const Time now = clock_();
  // The second condition also trims if the clock was set back.
  if (now < next_trim_ && next_trim_ - now <= options_.trim_interval) return;
  next_trim_ = now + options_.trim_interval;
  if (!is_listening_) is_listening_ = watch(listening_.get(), kListening).ok();
  pool_.trim(now);
  std::vector<Key> silent;
  for (auto& [key, connection] : connections_) {
    for (auto slab = connection.given.begin(); slab != connection.given.end();) {
      if (pool_.has_slab(*slab)) {
        ++slab;
        continue;
      }
      const Message gone = answer(Message::Kind::kSlabGone, *slab, {});
      slab = connection.given.erase(slab);
      if (send_message(connection.socket.get(), gone).ok()) continue;
      silent.push_back(key);
      break;
    }
  }
  for (const Key key : silent) {
    ++cut_off_;
    close(key);
  }
}

}  // namespace engram::server
