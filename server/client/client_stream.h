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

/// The streams of one owner, to wait for the end of the last one.
///
/// A stream keeps its channel until it is destroyed, by one of gRPC's threads. Were that the last
/// to know the channel, gRPC would end its threads from within one of them and free their queue
/// twice (1.51): who owns a channel waits here before letting go of it.
/// Threading: thread-safe; wait() not by a handler of one of the streams.
class OpenStreams {
 public:
  /// To be kept by a stream as long as it is there.
  [[nodiscard]] std::shared_ptr<void> enter();

  /// Until all are destroyed.
  void wait();

 private:
  struct State {
    Mutex mutex;
    ConditionVariable changed;
    size_t count ENGRAM_GUARDED_BY(mutex) = 0;
  };

  const std::shared_ptr<State> state_ = std::make_shared<State>();
};

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

  /// Opens the stream `method` ("/engram.v1.MemoryServer/Commit"), one of `streams`. `session`: of
  /// shared memory.
  static std::shared_ptr<ClientStream> open(const std::shared_ptr<grpc::Channel>& channel,
                                            const std::string& method, const std::string& token,
                                            OpenStreams& streams, Handlers handlers,
                                            const std::string& session = {});

  /// Errors: kUnavailable where the stream has ended.
  Status send(grpc::ByteBuffer request);

  [[nodiscard]] bool is_open() const;

  /// Ends it; on_end follows.
  void cancel();

  void OnReadDone(bool ok) override;
  void OnWriteDone(bool ok) override;
  void OnDone(const grpc::Status& status) override;

 private:
  ClientStream(OpenStreams& streams, Handlers handlers)
      : entered_(streams.enter()), handlers_(std::move(handlers)) {}

  const std::shared_ptr<void> entered_;  ///< The first member: goes after the context.
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
