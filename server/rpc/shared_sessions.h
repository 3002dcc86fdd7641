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
  static Result<std::unique_ptr<SharedSessions>> start(const std::filesystem::path& socket,
                                                       const SharedPool::Options& options,
                                                       NoteReader note_reader);
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

  [[nodiscard]] const SharedPool& pool() const { return *pool_; }

 private:
  struct Session {
    std::string secret;
    Identity who;
  };

  SharedSessions(std::filesystem::path socket, NoteReader note_reader)
      : socket_(std::move(socket)), note_reader_(std::move(note_reader)) {}
  GroupId group_of(const std::string& memory) ENGRAM_EXCLUDES(mutex_);
  void forget(ClientId client) ENGRAM_EXCLUDES(mutex_);

  const std::filesystem::path socket_;
  const NoteReader note_reader_;
  std::unique_ptr<SharedPool> pool_;
  mutable Mutex mutex_;
  ClientId last_client_ ENGRAM_GUARDED_BY(mutex_) = 0;
  std::map<ClientId, Session> sessions_ ENGRAM_GUARDED_BY(mutex_);
  std::unordered_map<std::string, ClientId> by_secret_ ENGRAM_GUARDED_BY(mutex_);
  std::map<std::string, GroupId> groups_ ENGRAM_GUARDED_BY(mutex_);
  /// Declared last, so that it ends first: it calls forget().
  std::unique_ptr<SharingServer> server_;
};

}  // namespace engram::server
