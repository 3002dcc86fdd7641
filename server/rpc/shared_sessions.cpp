// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/shared_sessions.h"

#include "ltm/core/log.h"
#include "server/access/token.h"

namespace engram::server {

namespace {

/// The max number of sessions; beyond it, sessions that were offered but not started are dropped.
constexpr size_t kMaxSessions = 1024;
/// The max size of a commit. A larger one could not be sent to clients elsewhere (ClientOptions).
constexpr size_t kMaxBlockBytes = size_t{256} << 20;

}  // namespace

Result<std::unique_ptr<SharedSessions>> SharedSessions::start(
    const std::filesystem::path& socket, const SharedPool::Options& options, NoteReader note_reader,
    std::function<void(ClientId)> on_closed) {
  std::unique_ptr<SharedSessions> sessions(
      new SharedSessions(socket, std::move(note_reader), std::move(on_closed)));
  ENGRAM_ASSIGN_OR_RETURN(sessions->pool_, SharedPool::create(options));
  SharingServer::Options serving;
  serving.socket = socket;
  serving.on_closed = [self = sessions.get()](ClientId client) {
    self->forget(client);
    if (self->on_closed_) self->on_closed_(client);
  };
  ENGRAM_ASSIGN_OR_RETURN(sessions->server_,
                          SharingServer::start(*sessions->pool_, std::move(serving)));
  return sessions;
}

SharedSessions::~SharedSessions() = default;

Result<v1::SharedMemory> SharedSessions::offer(const Identity& who) {
  ENGRAM_ASSIGN_OR_RETURN(std::string secret, make_token());
  ClientId client = 0;
  {
    const MutexLock lock(mutex_);
    if (sessions_.size() >= kMaxSessions)
      return resource_exhausted("shared memory: found {} clients, needs fewer", sessions_.size());
    client = ++last_client_;
    sessions_.emplace(client, Session{secret, who});
    by_secret_.emplace(secret, client);
  }
  auto ticket = server_->issue_ticket(client);
  if (!ticket.ok()) {
    forget(client);
    return ticket.status();
  }
  v1::SharedMemory offered;
  offered.set_socket(socket_.string());
  offered.set_ticket(ticket->data(), ticket->size());
  offered.set_session(std::move(secret));
  return offered;
}

ClientId SharedSessions::find(const std::string& session) const {
  const MutexLock lock(mutex_);
  const auto found = by_secret_.find(session);
  return found == by_secret_.end() ? kServerItself : found->second;
}

Result<BlockRef> SharedSessions::lease(ClientId writer, const std::string& memory, size_t bytes) {
  if (bytes > kMaxBlockBytes)
    return resource_exhausted("shared memory: found {} bytes, needs at most {}", bytes,
                              kMaxBlockBytes);
  return pool_->lease(writer, group_of(memory), bytes);
}

Result<Buffer> SharedSessions::commit(ClientId writer, const std::string& memory,
                                      const BlockRef& block, size_t bytes) {
  return pool_->commit(writer, group_of(memory), block, bytes);
}

Status SharedSessions::share(const BlockRef& block, const std::string& memory, ClientId reader) {
  Status status = pool_->share(block, reader);
  if (status.code() != StatusCode::kFailedPrecondition) return status;
  ENGRAM_ASSIGN_OR_RETURN(const auto id, ltm::MemoryId::from_names({memory}));
  std::string who;
  {
    const MutexLock lock(mutex_);
    const auto session = sessions_.find(reader);
    if (session == sessions_.end()) return status;
    // A block may hold anything of its memory.
    if (!session->second.who.may_read_all(id)) return status;
    who = session->second.who.name();
  }
  ENGRAM_RETURN_IF_ERROR(note_reader_(who, memory));
  ENGRAM_RETURN_IF_ERROR(pool_->grant_read(reader, group_of(memory)));
  return pool_->share(block, reader);
}

void SharedSessions::release(ClientId reader, const BlockRef& block) {
  // Releasing a block that the client does not have harms only that client; the pool counts it.
  if (const Status status = pool_->release(reader, block); !status.ok())
    log::debug("shared memory: client {}: {}", reader, status.message());
}

Result<SharedSessions::RingMemory> SharedSessions::lease_ring(ClientId writer, size_t entry_bytes,
                                                              size_t control_bytes) {
  RingMemory ring;
  GroupId told = 0;
  {
    const MutexLock lock(mutex_);
    const auto session = sessions_.find(writer);
    if (session == sessions_.end()) return failed_precondition("shared memory: no such session");
    if (session->second.told == 0) session->second.told = ++last_ring_group_;
    told = session->second.told;
    ring.group = ++last_ring_group_;
  }
  ENGRAM_ASSIGN_OR_RETURN(ring.entries, pool_->lease(writer, ring.group, entry_bytes));
  const auto make_control = [&]() -> Status {
    ENGRAM_ASSIGN_OR_RETURN(ring.control, pool_->lease(kServerItself, told, control_bytes));
    ENGRAM_ASSIGN_OR_RETURN(ring.control_written, pool_->writable(ring.control));
    ENGRAM_ASSIGN_OR_RETURN(ring.control_kept,
                            pool_->commit(kServerItself, told, ring.control, control_bytes));
    ENGRAM_RETURN_IF_ERROR(pool_->grant_read(writer, told));
    return pool_->share(ring.control, writer);
  };
  Status made = make_control();
  if (made.ok()) return ring;
  abandon_ring(writer, ring);
  return made;
}

Result<Buffer> SharedSessions::begin_ring(ClientId writer, const RingMemory& ring) {
  return pool_->commit(writer, ring.group, ring.entries, ring.entries.capacity);
}

void SharedSessions::abandon_ring(ClientId writer, const RingMemory& ring) {
  // It fails where the client is gone, which took the lease back, or where the ring has begun.
  if (const Status status = pool_->abandon(writer, ring.entries); !status.ok())
    log::debug("shared memory: a ring of client {}: {}", writer, status.message());
}

Result<SharedSessions::OwnBlock> SharedSessions::lease_own(const std::string& memory,
                                                           size_t bytes) {
  OwnBlock own;
  ENGRAM_ASSIGN_OR_RETURN(own.block, lease(kServerItself, memory, bytes));
  ENGRAM_ASSIGN_OR_RETURN(own.bytes, pool_->writable(own.block));
  own.bytes = own.bytes.first(bytes);
  return own;
}

Result<Buffer> SharedSessions::commit_own(const std::string& memory, const OwnBlock& own) {
  return pool_->commit(kServerItself, group_of(memory), own.block, own.bytes.size());
}

void SharedSessions::abandon_own(const OwnBlock& own) {
  if (const Status status = pool_->abandon(kServerItself, own.block); !status.ok())
    log::debug("shared memory: a block of the server: {}", status.message());
}

GroupId SharedSessions::group_of(const std::string& memory) {
  const MutexLock lock(mutex_);
  const auto [group, is_new] =
      groups_.try_emplace(memory, static_cast<GroupId>(groups_.size() + 1));
  return group->second;
}

void SharedSessions::forget(ClientId client) {
  const MutexLock lock(mutex_);
  const auto found = sessions_.find(client);
  if (found == sessions_.end()) return;
  by_secret_.erase(found->second.secret);
  sessions_.erase(found);
}

}  // namespace engram::server
