// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <deque>
#include <set>
#include <thread>
#include <unordered_map>

#include "ltm/core/mutex.h"
#include "server/sharing/channel.h"
#include "server/sharing/listening_socket.h"
#include "server/sharing/sharing_server.h"
#include "server/sharing/ticket_book.h"

namespace engram::server {

/// The thread of a SharingServer: one event loop over all sockets, which never waits for a single
/// socket.
///
/// Threading: public functions from any thread, the rest on its own thread.
class SharingServer::Loop {
 public:
  Loop(SharedPool& pool, Options options, Clock clock, ListeningSocket listening, Descriptor events,
       Descriptor wake)
      : pool_(pool),
        options_(std::move(options)),
        clock_(std::move(clock)),
        tickets_(options_.ticket_lifetime, options_.max_tickets),
        listening_(std::move(listening)),
        events_(std::move(events)),
        wake_(std::move(wake)) {}
  ~Loop();

  /// Errors: kUnavailable.
  Status start();

  Result<Ticket> issue_ticket(ClientId client, std::vector<GroupId> readable);
  [[nodiscard]] bool is_connected(ClientId client) const;
  void disconnect(ClientId client);
  [[nodiscard]] SharingCounters counters() const;

 private:
  /// An epoll event carries twice the key of its connection, plus one if it reports that the
  /// process ended.
  using Key = uint64_t;
  static constexpr Key kListening = 0;

  struct Connection {
    Descriptor socket;
    Descriptor process;
    ClientId client = kServerItself;  ///< kServerItself until the client is welcomed.
    std::set<SlabId> given;
  };
  struct Pending {
    Key key;
    Time deadline;
  };

  void run(const std::stop_token& stop);
  [[nodiscard]] int wait_ms() const;
  Status watch(int fd, uint64_t event);

  void accept_peers();
  void accept_peer(Descriptor socket);
  void drop_pending(const Pending& pending);
  void drop_late();

  /// Serves one message. An error means that the connection must be closed.
  Status serve(Key key, Connection& connection);
  Status welcome(Key key, Connection& connection, const Message& hello);
  Status give_slab(Connection& connection, SlabId slab);
  void watch_process(Key key, Connection& connection);
  void close(Key key);
  void tell_gone();

  SharedPool& pool_;
  const Options options_;
  const Clock clock_;
  TicketBook tickets_;
  ListeningSocket listening_;
  Descriptor events_;
  Descriptor wake_;

  Key last_key_ = kListening;
  std::unordered_map<Key, Connection> connections_;
  std::deque<Pending> pending_;  ///< In the order of arrival.
  bool is_listening_ = true;
  Time next_trim_{};

  mutable Mutex mutex_;
  /// The sockets of clients.
  std::unordered_map<ClientId, int> sockets_ ENGRAM_GUARDED_BY(mutex_);

  std::atomic<uint64_t> accepted_{0}, welcomed_{0}, refused_{0}, cut_off_{0};
  std::jthread thread_;
};

}  // namespace engram::server
