// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <unordered_set>

#include "server/rpc/reply_stream.h"
#include "server/rpc/rpc_context.h"
#include "server/wire/wire_snapshot.h"

namespace engram::server {

/// The commit stream of one writer: accepts commits in their order and notifies subscribers.
///
/// Commits of durability kMemory are acknowledged in their order; others once they are durable, so
/// their replies may come later than those of younger commits.
class CommitStream final : public ReplyStream {
 public:
  CommitStream(RpcContext& context, Identity who, ClientId sharing)
      : context_(context), who_(std::move(who)), sharing_(sharing) {}

 private:
  /// The segments of updates that are sensory, as the client is told of them.
  using SensoryNames = std::vector<std::string>;

  Status on_request(grpc::ByteBuffer& request) override;
  Result<ltm::Admission> commit(v1::CommitRequest& message,
                                memory::MemoryService::Durability durability,
                                SensoryNames& sensory);
  Result<WireCommit> take(v1::CommitRequest& message);
  /// Whether the writer may write this entity.
  Status check(const ltm::MemoryId& entity, Time time);
  void reply(uint64_t number, const Status& status, const std::optional<BlockRef>& leased = {},
             const SensoryNames& sensory = {});
  /// Gives a client a ring for sensory entities that it may write.
  Result<v1::SensoryRing> open_ring(const v1::CommitRequest& message);
  void reply_with_ring(const v1::CommitRequest& message);
  [[nodiscard]] SensoryNames sensory_of(const ltm::Commit& commit) const;
  std::optional<BlockRef> lease(const v1::CommitRequest& message);
  void publish(const ltm::Admission& admission);

  RpcContext& context_;
  const Identity who_;
  const ClientId sharing_;  ///< kServerItself if it shares no memory.
  /// Entities whose first commit the audit log has: up to kMaxNoted of them, none without a log.
  /// Requests come one at a time.
  static constexpr size_t kMaxNoted = 100'000;
  std::unordered_set<std::string> noted_;
  const StreamSlot slot_{context_, who_};
};

}  // namespace engram::server
