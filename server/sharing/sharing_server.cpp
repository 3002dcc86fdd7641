// SPDX-License-Identifier: Apache-2.0
#include "server/sharing/sharing_server.h"

#include <sys/epoll.h>
#include <sys/eventfd.h>

#include "server/sharing/sharing_loop.h"

namespace engram::server {

Status SharingServer::Options::validate() const {
  ENGRAM_RETURN_IF_ERROR(check_socket_path(socket));
  if ((mode & ~mode_t{0660}) != 0)
    return invalid_argument("mode: found {:o}, needs no more than 660", mode);
  if (max_connections == 0 || max_pending == 0 || max_tickets == 0)
    return invalid_argument("max_connections, max_pending, max_tickets: need at least one");
  if (handshake_timeout <= Duration(0) || ticket_lifetime <= Duration(0) ||
      trim_interval <= Duration(0))
    return invalid_argument("handshake_timeout, ticket_lifetime, trim_interval: need more than 0s");
  return {};
}

SharingServer::SharingServer(std::unique_ptr<Loop> loop) : loop_(std::move(loop)) {}
SharingServer::~SharingServer() = default;

Result<std::unique_ptr<SharingServer>> SharingServer::start(SharedPool& pool, Options options,
                                                            Clock clock) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  ENGRAM_ASSIGN_OR_RETURN(auto listening, ListeningSocket::open(options.socket, options.mode));
  Descriptor events(::epoll_create1(EPOLL_CLOEXEC));
  if (!events.is_open()) return system_status("sharing: cannot watch");
  Descriptor wake(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (!wake.is_open()) return system_status("sharing: cannot watch");
  auto loop = std::make_unique<Loop>(pool, std::move(options), std::move(clock),
                                     std::move(listening), std::move(events), std::move(wake));
  ENGRAM_RETURN_IF_ERROR(loop->start());
  return std::unique_ptr<SharingServer>(new SharingServer(std::move(loop)));
}

Result<Ticket> SharingServer::issue_ticket(ClientId client, std::vector<GroupId> readable) {
  return loop_->issue_ticket(client, std::move(readable));
}

bool SharingServer::is_connected(ClientId client) const {
  return loop_->is_connected(client);
}

void SharingServer::disconnect(ClientId client) {
  loop_->disconnect(client);
}

SharingCounters SharingServer::counters() const {
  return loop_->counters();
}

}  // namespace engram::server
