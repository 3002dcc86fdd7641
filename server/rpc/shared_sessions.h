// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <engram/v1/memory.pb.h>

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <unordered_map>

#include "ltm/core/mutex.h"
#include "server/access/access_policy.h"
#include "server/sharing/shared_pool.h"
#include "server/sharing/sharing_server.h"

namespace engram::server {

/// Tracks which clients of this host share memory with the server, and what each may read: the
/// blocks of every memory that it may read as a whole.
///
/// Threading: thread-safe.
/// Source: docs/sharing.md.
class SharedSessions {
 public:
  /// Notes that somebody may read a whole memory from now on.
  /// Errors: why it cannot be noted; the memory is not shared then.
  using NoteReader = std::function<Status(const std::string& who, const std::string& memory)>;

  /// Starts sharing. Clients fetch the memory at `socket`, in a folder that only the server owns.
  /// Errors: those of SharedPool::create and SharingServer::start.
  /// `on_closed` is called by a thread of the server once a client is gone.
  static Result<std::unique_ptr<SharedSessions>> start(
      const std::filesystem::path& socket, const SharedPool::Options& options,
      NoteReader note_reader, std::function<void(ClientId)> on_closed = {});
  ~SharedSessions();

  /// Returns what a client needs to start a session.
  /// Errors: those of SharingServer::issue_ticket.
  Result<v1::SharedMemory> offer(const Identity& who);

  /// Returns the client of a session, or kServerItself if there is none.
  [[nodiscard]] ClientId find(const std::string& session) const;

  /// See SharedPool. A block belongs to one memory.
  Result<BlockRef> lease(ClientId writer, const std::string& memory, size_t bytes);
  Result<Buffer> commit(ClientId writer, const std::string& memory, const BlockRef& block,
                        size_t bytes);
  /// Lets a client read a block of a memory if it has access.
  Status share(const BlockRef& block, const std::string& memory, ClientId reader);
  void release(ClientId reader, const BlockRef& block);

  /// The memory of a ring that one client writes and the server reads, and that of what the server
  /// tells the client. Nobody else may map either.
  struct RingMemory {
    BlockRef entries;
    BlockRef control;
    GroupId group = 0;                     ///< Of the entries.
    std::span<std::byte> control_written;  ///< The control's bytes, for the server to write.
    Buffer control_kept;                   ///< Keeps these.
  };
  /// Errors: those of SharedPool::lease and share.
  Result<RingMemory> lease_ring(ClientId writer, size_t entry_bytes, size_t control_bytes);
  /// The entries of a ring, once its client has mapped it.
  /// Errors: those of SharedPool::commit.
  Result<Buffer> begin_ring(ClientId writer, const RingMemory& ring);
  void abandon_ring(ClientId writer, const RingMemory& ring);

  /// A block that the server itself fills: readers of the memory may see it from now on.
  struct OwnBlock {
    BlockRef block;
    std::span<std::byte> bytes;
  };
  Result<OwnBlock> lease_own(const std::string& memory, size_t bytes);
  Result<Buffer> commit_own(const std::string& memory, const OwnBlock& own);
  void abandon_own(const OwnBlock& own);

  [[nodiscard]] const SharedPool& pool() const { return *pool_; }

 private:
  struct Session {
    std::string secret;
    Identity who;
    /// The group of what the server tells this client alone; zero until there is any.
    GroupId told = 0;
  };

  SharedSessions(std::filesystem::path socket, NoteReader note_reader,
                 std::function<void(ClientId)> on_closed)
      : socket_(std::move(socket)),
        note_reader_(std::move(note_reader)),
        on_closed_(std::move(on_closed)) {}
  GroupId group_of(const std::string& memory) ENGRAM_EXCLUDES(mutex_);
  void forget(ClientId client) ENGRAM_EXCLUDES(mutex_);

  const std::filesystem::path socket_;
  const NoteReader note_reader_;
  const std::function<void(ClientId)> on_closed_;
  std::unique_ptr<SharedPool> pool_;
  mutable Mutex mutex_;
  ClientId last_client_ ENGRAM_GUARDED_BY(mutex_) = 0;
  std::map<ClientId, Session> sessions_ ENGRAM_GUARDED_BY(mutex_);
  std::unordered_map<std::string, ClientId> by_secret_ ENGRAM_GUARDED_BY(mutex_);
  std::map<std::string, GroupId> groups_ ENGRAM_GUARDED_BY(mutex_);
  /// Those of rings are above those of memories.
  GroupId last_ring_group_ ENGRAM_GUARDED_BY(mutex_) = GroupId{1} << 31;
  /// Declared last, so that it ends first: it calls forget().
  std::unique_ptr<SharingServer> server_;
};

}  // namespace engram::server
