// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <engram/v1/memory.pb.h>
#include <grpcpp/support/server_callback.h>

#include <optional>
#include <thread>

#include "ltm/core/mutex.h"
#include "server/rpc/rpc_context.h"

namespace engram::server {

/// One call that forgets. It works in a thread of its own, tells how far it is, and stops when the
/// call is cancelled.
class ForgetStream final : public grpc::ServerWriteReactor<v1::ForgetReply> {
 public:
  /// Begins what `who` asks, or ends the call with the reason why not. It deletes itself.
  static ForgetStream* begin(RpcContext& context, const Result<Identity>& who,
                             const v1::ForgetRequest& request);

  void OnWriteDone(bool ok) override;
  void OnCancel() override;
  void OnDone() override;

 private:
  explicit ForgetStream(RpcContext& context) : context_(context) {}

  Result<memory::ForgetOutcome> forget(const Identity& who, const v1::ForgetRequest& message);
  void tell(const Progress& progress) ENGRAM_EXCLUDES(mutex_);
  void end(Result<memory::ForgetOutcome> outcome) ENGRAM_EXCLUDES(mutex_);
  void end_call() ENGRAM_REQUIRES(mutex_);

  RpcContext& context_;
  std::stop_source stop_;
  SteadyTime told_{};  ///< Of the working thread alone.

  Mutex mutex_;
  v1::ForgetReply written_ ENGRAM_GUARDED_BY(mutex_);
  bool is_writing_ ENGRAM_GUARDED_BY(mutex_) = false;
  v1::ForgetReply last_ ENGRAM_GUARDED_BY(mutex_);
  std::optional<Status> ended_ ENGRAM_GUARDED_BY(mutex_);  ///< Set when the work has ended.
  bool has_ended_call_ ENGRAM_GUARDED_BY(mutex_) = false;
  std::jthread thread_;  ///< The last member, so it ends first.
};

}  // namespace engram::server
