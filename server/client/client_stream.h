// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/client_callback.h>

#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "ltm/core/status.h"

namespace engram::server {

/// The client's end of a stream of requests and replies, in bytes.
///
/// Threading: thread-safe. Handlers are called by gRPC's threads, one at a time, and must not wait.
class ClientStream final : public grpc::ClientBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>,
                           public std::enable_shared_from_this<ClientStream> {
 public:
  struct Handlers {
    std::function<void(grpc::ByteBuffer&)> on_reply;
    /// Once, when the stream has ended for whatever reason; nothing is sent or told after it.
    std::function<void(const Status&)> on_end;
  };

  /// Opens the stream `method` ("/engram.v1.MemoryServer/Commit"). `session`: of shared memory.
  static std::shared_ptr<ClientStream> open(const std::shared_ptr<grpc::Channel>& channel,
                                            const std::string& method, const std::string& token,
                                            Handlers handlers, const std::string& session = {});

  /// Errors: kUnavailable where the stream has ended.
  Status send(grpc::ByteBuffer request);

  [[nodiscard]] bool is_open() const;

  /// Ends it; on_end follows.
  void cancel();

  void OnReadDone(bool ok) override;
  void OnWriteDone(bool ok) override;
  void OnDone(const grpc::Status& status) override;

 private:
  explicit ClientStream(Handlers handlers) : handlers_(std::move(handlers)) {}

  Handlers handlers_;
  grpc::ClientContext context_;
  std::shared_ptr<ClientStream> self_;
  grpc::ByteBuffer reply_;

  mutable std::mutex mutex_;
  std::deque<grpc::ByteBuffer> waiting_;
  grpc::ByteBuffer written_;
  bool is_writing_ = false;
  bool is_open_ = true;
};

}  // namespace engram::server
