// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/rpc/reply_stream.h"
#include "server/rpc/rpc_context.h"
#include "server/wire/wire_snapshot.h"

namespace engram::server {

/// Takes the commits of one writer, in their order, and tells subscribers.
///
/// Commits that only have to be in memory are acknowledged in their order; others when they are
/// durable.
class CommitStream final : public ReplyStream {
 public:
  CommitStream(RpcContext& context, Identity who) : context_(context), who_(std::move(who)) {}

 private:
  Status on_request(grpc::ByteBuffer& request) override;
  Result<Admission> commit(v1::CommitRequest& message, MemoryService::Durability durability);
  void reply(uint64_t number, const Status& status);
  void publish(const Admission& admission);

  RpcContext& context_;
  const Identity who_;
  const StreamSlot slot_{context_};
};

}  // namespace engram::server
