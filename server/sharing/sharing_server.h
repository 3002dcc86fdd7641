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

/// What came to a SharingServer since it was started.
struct SharingCounters {
  size_t connected = 0;  ///< Clients, now.
  uint64_t accepted = 0;
  uint64_t welcomed = 0;
  uint64_t refused = 0;  ///< Before they were welcome: another user, no ticket, too slow, too many.
  uint64_t cut_off = 0;  ///< Afterwards, for what they sent or did not read.
};

/// Hands the memory of a SharedPool to processes of this host, over a Unix socket, and takes it
/// back when they end. A thread of its own does so; it also trims the pool.
///
/// A client shows a ticket that the application issued to it by other means. A peer that says
/// anything unexpected, or does not read what it asked for, is cut off; none is waited for.
/// Threading: thread-safe; `on_closed` is called on the thread of its own, and holds it up.
/// Source: docs/sharing.md.
class SharingServer {
 public:
  struct Options {
    /// Its directory must exist and belong to this user or root. At most 107 bytes.
    std::filesystem::path socket;
    mode_t mode = 0600;             ///< Of the socket: who may connect. 0660: the group too.
    std::vector<uid_t> other_uids;  ///< Whose processes are welcome beside this user's.
    size_t max_connections = 64;    ///< Of clients; each takes two descriptors.
    /// That have not shown a ticket yet; the oldest makes room.
    size_t max_pending = 16;
    Duration handshake_timeout = std::chrono::seconds(2);
    Duration ticket_lifetime = std::chrono::seconds(30);
    size_t max_tickets = 1024;
    /// How often the pool is trimmed, and clients hear of slabs that are gone.
    Duration trim_interval = std::chrono::seconds(1);
    /// A client is gone, and what it had is taken back.
    std::function<void(ClientId)> on_closed;

    /// Errors: kInvalidArgument.
    [[nodiscard]] Status validate() const;
  };

  /// `pool` must outlive it.
  /// Errors: kInvalidArgument; kFailedPrecondition where another server listens there or the path
  /// is not to be trusted; kResourceExhausted, kUnavailable.
  static Result<std::unique_ptr<SharingServer>> start(SharedPool& pool, Options options,
                                                      Clock clock = system_now);

  /// Closes all connections and removes the socket.
  ~SharingServer();

  /// Lets a process connect as `client`, once and soon. It may read these groups, and what
  /// SharedPool::grant_read adds later.
  /// Errors: kInvalidArgument, kResourceExhausted, kUnavailable.
  Result<Ticket> issue_ticket(ClientId client, std::vector<GroupId> readable = {});

  [[nodiscard]] bool is_connected(ClientId client) const;

  /// Closes its connection, soon. Fine where there is none.
  void disconnect(ClientId client);

  [[nodiscard]] SharingCounters counters() const;

 private:
  class Loop;
  explicit SharingServer(std::unique_ptr<Loop> loop);

  std::unique_ptr<Loop> loop_;
};

}  // namespace engram::server
