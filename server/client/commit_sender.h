// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <engram/v1/memory.grpc.pb.h>

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ltm/core/mutex.h"
#include "ltm/memory/commit.h"
#include "memory/memory.h"
#include "server/client/calls.h"
#include "server/client/client_options.h"
#include "server/client/loan.h"
#include "server/client/sensory_lane.h"
#include "server/client/shared_lane.h"

namespace engram::server {

/// Brings the commits of one client to its server: into a ring of sensory memory, through a block
/// of shared memory, or in a message.
///
/// Threading: thread-safe.
class CommitSender {
 public:
  /// `shares_memory` says whether the server is on this host. The stub must outlive it.
  CommitSender(const ClientOptions& options, std::string endpoint, bool shares_memory,
               std::shared_ptr<grpc::Channel> channel, v1::MemoryServer::Stub& stub);

  /// Sends a commit once. `done` may be called by this thread or by one of gRPC.
  void send(const ltm::Commit& commit, CommitDurability durability,
            const std::function<void(const Status&)>& done);

  /// See MemoryClient::lend().
  Result<Loan> lend(std::span<const ArrayToLend> arrays);

  /// The memory that it shares with the server; null if it shares none.
  std::shared_ptr<SharedLane> lane() { return shared().lane; }

  /// Lets nobody wait any more.
  void close();

 private:
  using Done = std::function<void(const Status&)>;
  using CommitCalls = Calls<v1::CommitReply>;

  /// What commits over shared memory need.
  struct SharedCommits {
    std::shared_ptr<SharedLane> lane;
    std::shared_ptr<CommitCalls> calls;
    std::shared_ptr<SensoryLane> sensory;
  };

  /// Returns the shared memory with the server. Asks the server for it if there is none; returns an
  /// empty value if the server is on another host or does not offer it.
  SharedCommits shared() ENGRAM_EXCLUDES(sharing_mutex_);
  /// Sends a request and waits for its reply.
  /// Errors: that of the reply; kUnavailable.
  Result<v1::CommitReply> ask(CommitCalls& calls, v1::CommitRequest request);
  static void send(CommitCalls& calls, v1::CommitRequest& request, CommitCalls::Pending pending);
  /// Notes which segments are sensory: their next commits need not be sent.
  void learn(const v1::CommitReply& reply) ENGRAM_EXCLUDES(sensory_mutex_);
  [[nodiscard]] bool is_sensory(const ltm::Commit& commit) ENGRAM_EXCLUDES(sensory_mutex_);
  /// Writes a commit into the client's ring, and tells the server where somebody attends. Returns
  /// false if it must be sent. A durable commit must not be lost, so it is sent.
  bool hold(const ltm::Commit& commit, CommitDurability durability, const Done& done);
  /// Returns a block to write into, or nothing if the server has no room.
  std::optional<BlockRef> lease(const SharedCommits& with, const std::string& memory, size_t bytes);
  /// Sends a commit through shared memory. Returns false if that is impossible: the caller then
  /// sends it through the stream.
  bool share(const ltm::Commit& commit, CommitDurability durability, const Done& done);

  const ClientOptions options_;
  const std::string endpoint_;
  const bool shares_memory_;
  const std::shared_ptr<grpc::Channel> channel_;
  v1::MemoryServer::Stub& stub_;
  const std::shared_ptr<CommitCalls> calls_;

  Mutex sharing_mutex_;
  SharedCommits sharing_ ENGRAM_GUARDED_BY(sharing_mutex_);
  /// The earliest time for the next try.
  SteadyTime share_again_ ENGRAM_GUARDED_BY(sharing_mutex_){};

  /// The sensory segments that the server told of so far. Most servers have none.
  std::atomic<bool> has_sensory_{false};
  SharedMutex sensory_mutex_;
  std::vector<ltm::MemoryId> sensory_ ENGRAM_GUARDED_BY(sensory_mutex_);
};

}  // namespace engram::server
