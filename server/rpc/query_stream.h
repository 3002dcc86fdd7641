// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/rpc/reply_stream.h"
#include "server/rpc/rpc_context.h"

namespace engram::server {

/// Answers the queries of one reader. What working memory knows is answered at once, the rest by
/// other threads: answers may come in another order than queries.
class QueryStream final : public ReplyStream {
 public:
  QueryStream(RpcContext& context, Identity who, ClientId /*sharing*/)
      : context_(context), who_(std::move(who)) {}

 private:
  Status on_request(grpc::ByteBuffer& request) override;
  void answer(uint64_t number, Result<ServedAnswer> answer);

  RpcContext& context_;
  const Identity who_;
  const StreamSlot slot_{context_};
};

}  // namespace engram::server
