// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/core/mutex.h"
#include "server/rpc/reply_stream.h"
#include "server/rpc/rpc_context.h"

namespace engram::server {

/// Answers the queries of one reader. What working memory knows is answered at once, the rest by
/// other threads, one after the other and as fast as the answers are read: they may come in another
/// order than queries.
class QueryStream final : public ReplyStream {
 public:
  QueryStream(RpcContext& context, Identity who, ClientId /*sharing*/)
      : context_(context), who_(std::move(who)) {}

 private:
  Status on_request(grpc::ByteBuffer& request) override;
  void on_sent() override { answer_next(); }
  void answer(uint64_t number, Result<ltm::Answer> answer);
  /// Lets another thread answer what waits, where that may be.
  void answer_next() ENGRAM_EXCLUDES(asking_);

  struct Asked {
    uint64_t number = 0;
    ltm::Query query;
    std::string engine;
  };

  RpcContext& context_;
  const Identity who_;
  const StreamSlot slot_{context_, who_};

  Mutex asking_;
  std::deque<Asked> asked_ ENGRAM_GUARDED_BY(asking_);  ///< For other threads. Each is promised.
  bool is_answering_ ENGRAM_GUARDED_BY(asking_) = false;
};

}  // namespace engram::server
