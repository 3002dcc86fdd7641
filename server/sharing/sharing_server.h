// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "ltm/core/status.h"
#include "ltm/core/time.h"
#include "server/sharing/shared_pool.h"

namespace engram::server {

/// Counters of a SharingServer since its start.
struct SharingCounters {
  size_t connected = 0;  ///< Number of clients now.
  uint64_t accepted = 0;
  uint64_t welcomed = 0;
  /// Peers refused before they were welcomed: another user, no ticket, too slow, too many.
  uint64_t refused = 0;
  uint64_t cut_off = 0;  ///< Clients closed later, for what they sent or because they did not read.
};

/// Gives processes of this host access to a SharedPool over a Unix socket, and takes the memory
/// back when they end. It runs a thread, which also trims the pool.
///
/// A client presents a ticket that the application issued to it by other means. A peer that sends
/// anything unexpected, or does not read what it requested, is disconnected; the server never waits
/// for a peer.
/// Threading: thread-safe. `on_closed` is called on the server's thread and blocks it meanwhile.
/// Source: docs/sharing.md.
class SharingServer {
 public:
  struct Options {
    /// Path of the socket, 107 bytes at most. Its folder must exist and belong to this user or
    /// root.
    std::filesystem::path socket;
    /// Mode of the socket, which decides who may connect. 0660 admits the group too.
    mode_t mode = 0600;
    std::vector<uid_t> other_uids;  ///< Users whose processes are admitted, beside this user.
    size_t max_connections = 64;    ///< Max clients; each takes two descriptors.
    /// Max peers without a ticket so far; the oldest makes room for a new one.
    size_t max_pending = 16;
    Duration handshake_timeout = std::chrono::seconds(2);
    Duration ticket_lifetime = std::chrono::seconds(30);
    size_t max_tickets = 1024;
    /// Interval at which the pool is trimmed and clients are told of slabs that are gone.
    Duration trim_interval = std::chrono::seconds(1);
    /// Called after a client is gone and everything it had was taken back.
    std::function<void(ClientId)> on_closed;

    /// Errors: kInvalidArgument.
    [[nodiscard]] Status validate() const;
  };

  /// Starts a server; `pool` must outlive it.
  /// Errors: kInvalidArgument; kFailedPrecondition if another server listens there or the path
  /// cannot be trusted; kResourceExhausted; kUnavailable.
  static Result<std::unique_ptr<SharingServer>> start(SharedPool& pool, Options options,
                                                      Clock clock = system_now);

  /// Closes all connections and removes the socket.
  ~SharingServer();

  /// Issues a ticket with which a process may connect as `client`, once and within ticket_lifetime.
  /// The client may read these groups, and those that SharedPool::grant_read adds later.
  /// Errors: kInvalidArgument, kResourceExhausted, kUnavailable.
  Result<Ticket> issue_ticket(ClientId client, std::vector<GroupId> readable = {});

  [[nodiscard]] bool is_connected(ClientId client) const;

  /// Closes a client's connection soon. Does nothing if there is none.
  void disconnect(ClientId client);

  [[nodiscard]] SharingCounters counters() const;

 private:
  class Loop;
  explicit SharingServer(std::unique_ptr<Loop> loop);

  std::unique_ptr<Loop> loop_;
};

}  // namespace engram::server
