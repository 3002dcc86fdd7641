// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <engram/v1/memory.pb.h>
#include <grpcpp/support/server_callback.h>

#include <stop_token>

#include "ltm/likeness/similar_moments.h"
#include "server/rpc/rpc_context.h"

namespace engram::server {

/// One question about likeness. It is answered by a thread that does nothing else, because images
/// without codes are decoded for it, and ends when the call is cancelled.
class SimilarCall final : public grpc::ServerUnaryReactor {
 public:
  /// Begins what `who` asks, or ends the call with the reason why not. It deletes itself. Both
  /// messages live until then.
  static SimilarCall* begin(RpcContext& context, const Result<Identity>& who,
                            const v1::SimilarRequest& request, v1::SimilarReply& reply);

  void OnCancel() override;
  void OnDone() override;

 private:
  explicit SimilarCall(RpcContext& context) : context_(context) {}

  Status answer(const Identity& who, const ltm::SimilarRequest& request, v1::SimilarReply& reply);

  RpcContext& context_;
  std::stop_source stop_;
};

}  // namespace engram::server
