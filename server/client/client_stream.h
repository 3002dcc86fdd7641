// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/client_callback.h>

#include <deque>
#include <functional>
#include <memory>
#include <string>

#include "ltm/core/mutex.h"
#include "ltm/core/status.h"

namespace engram::server {

/// Counts the open streams of one owner, so that the owner can wait until the last one is
/// destroyed.
///
/// A stream keeps its channel until one of gRPC's threads destroys the stream. If that stream held
/// the last reference to the channel, gRPC would end its threads from within one of them and free
/// their queue twice (gRPC 1.51). The owner of a channel therefore waits here before it releases
/// the channel.
/// Threading: thread-safe. wait() must not be called by a handler of one of the streams.
class OpenStreams {
 public:
  /// Returns a token that a stream keeps for its whole life.
  [[nodiscard]] std::shared_ptr<void> enter();

  /// Blocks until all streams are destroyed.
  void wait();

 private:
  struct State {
    Mutex mutex;
    ConditionVariable changed;
    size_t count ENGRAM_GUARDED_BY(mutex) = 0;
  };

  const std::shared_ptr<State> state_ = std::make_shared<State>();
};

/// The client's end of a bidirectional stream of requests and replies, as bytes.
///
/// Threading: thread-safe. gRPC's threads call the handlers, one at a time; handlers must not
/// block.
class ClientStream final : public grpc::ClientBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>,
                           public std::enable_shared_from_this<ClientStream> {
 public:
  struct Handlers {
    std::function<void(grpc::ByteBuffer&)> on_reply;
    /// Called once when the stream has ended for any reason. No handler is called after it.
    std::function<void(const Status&)> on_end;
  };

  /// Opens the stream of the RPC `method`, such as "/engram.v1.MemoryServer/Commit", and counts it
  /// in `streams`. `session` names a session of shared memory and may be empty.
  static std::shared_ptr<ClientStream> open(const std::shared_ptr<grpc::Channel>& channel,
                                            const std::string& method, const std::string& token,
                                            OpenStreams& streams, Handlers handlers,
                                            const std::string& session = {});

  /// Queues a request and returns without waiting for it to be written.
  /// Errors: kUnavailable if the stream has ended.
  Status send(grpc::ByteBuffer request);

  [[nodiscard]] bool is_open() const;

  /// Cancels the stream; `on_end` is called afterwards.
  void cancel();

  void OnReadDone(bool ok) override;
  void OnWriteDone(bool ok) override;
  void OnDone(const grpc::Status& status) override;

 private:
  ClientStream(OpenStreams& streams, Handlers handlers)
      : entered_(streams.enter()), handlers_(std::move(handlers)) {}

  /// Declared first, so that it is destroyed after the context.
  const std::shared_ptr<void> entered_;
  Handlers handlers_;
  grpc::ClientContext context_;
  std::shared_ptr<ClientStream> self_;
  grpc::ByteBuffer reply_;

  mutable Mutex mutex_;
  std::deque<grpc::ByteBuffer> waiting_ ENGRAM_GUARDED_BY(mutex_);
  grpc::ByteBuffer written_ ENGRAM_GUARDED_BY(mutex_);
  bool is_writing_ ENGRAM_GUARDED_BY(mutex_) = false;
  bool is_open_ ENGRAM_GUARDED_BY(mutex_) = true;
};

}  // namespace engram::server
