// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <engram/v1/memory.pb.h>

#include "ltm/core/mutex.h"
#include "server/rpc/reply_stream.h"
#include "server/rpc/rpc_context.h"

namespace engram::server {

/// The query stream of one reader. Queries that working memory can answer are answered at once. The
/// others are answered by other threads, one after the other and as fast as the client reads the
/// answers, so answers may come in another order than their queries. Large answers are made part by
/// part, so they cost as little memory as small ones, and other streams get their turn in between.
class QueryStream final : public ReplyStream {
 public:
  QueryStream(RpcContext& context, Identity who, ClientId /*sharing*/)
      : context_(context), who_(std::move(who)) {}

 private:
  /// What a message asks to predict.
  struct Predicted {
    ltm::MemoryId entity;
    ltm::PredictionRequest request;
  };

  Status on_request(grpc::ByteBuffer& request) override;
  void on_sent() override { answer_next(); }
  void on_query(const v1::QueryRequest& message);
  void on_prediction(const v1::QueryRequest& message);
  void answer(uint64_t number, Result<ltm::Answer> answer, bool is_last = true);
  void redact(ltm::Answer& answer) const;
  [[nodiscard]] Status check_named(const ltm::Query& query) const;
  [[nodiscard]] Result<Predicted> asked_of(const v1::QueryRequest& message) const;
  /// Hands the next waiting query to another thread, if none is being answered and the client keeps
  /// up with reading.
  void answer_next() ENGRAM_EXCLUDES(asking_);

  struct Asked {
    uint64_t number = 0;
    /// Makes the next part of the answer, and says whether it is the last one. Called by another
    /// thread.
    std::function<Result<ltm::Answer>(bool& is_last)> next_part;
    int parts = 0;  ///< That were made.
  };

  void answer_later(Asked asked) ENGRAM_EXCLUDES(asking_);

  RpcContext& context_;
  const Identity who_;
  const ltm::SharedView view_ = who_.view();  ///< Null: everything.
  const StreamSlot slot_{context_, who_};

  Mutex asking_;
  /// Questions for other threads; promise() was called for each.
  std::deque<Asked> asked_ ENGRAM_GUARDED_BY(asking_);
  bool is_answering_ ENGRAM_GUARDED_BY(asking_) = false;
};

}  // namespace engram::server
