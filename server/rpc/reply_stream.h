// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/server_callback.h>

#include <deque>
#include <memory>

#include "ltm/core/mutex.h"
#include "ltm/core/status.h"

namespace engram::server {

/// The server's end of a stream of requests and replies, in bytes. Requests are read one at a time;
/// none is read while too many replies wait: a client that does not read is slowed, and costs
/// bounded memory.
///
/// Threading: thread-safe; on_request() is called by one thread at a time.
class ReplyStream : public grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>,
                    public std::enable_shared_from_this<ReplyStream> {
 public:
  /// Replies that may wait before the next request is read.
  static constexpr size_t kMaxReplies = 256;
  static constexpr size_t kMaxReplyBytes = size_t{16} << 20;

  /// Lives from here on until the stream has ended.
  void begin();

  void OnReadDone(bool ok) final;
  void OnWriteDone(bool ok) final;
  void OnCancel() final;
  void OnDone() final;

 protected:
  /// Answers at once, or promises replies and gives them later. Errors end the stream.
  virtual Status on_request(grpc::ByteBuffer& request) = 0;
  /// The stream has ended; nothing is sent any more.
  virtual void on_end() {}
  /// A reply has gone: has_room() may be true now.
  virtual void on_sent() {}

  /// Few enough replies wait for more of them to be made.
  [[nodiscard]] bool has_room() ENGRAM_EXCLUDES(mutex_);

  /// One reply more, or fewer, will come later: the stream does not end before.
  void promise() ENGRAM_EXCLUDES(mutex_);
  void fulfil() ENGRAM_EXCLUDES(mutex_);

  void send(grpc::ByteBuffer reply) ENGRAM_EXCLUDES(mutex_);
  /// Sends what waits, then ends the stream.
  void end(const Status& status) ENGRAM_EXCLUDES(mutex_);

 private:
  void go_on() ENGRAM_REQUIRES(mutex_);

  std::shared_ptr<ReplyStream> self_;
  grpc::ByteBuffer request_;

  Mutex mutex_;
  std::deque<grpc::ByteBuffer> waiting_ ENGRAM_GUARDED_BY(mutex_);
  grpc::ByteBuffer written_ ENGRAM_GUARDED_BY(mutex_);
  size_t waiting_bytes_ ENGRAM_GUARDED_BY(mutex_) = 0;
  size_t promised_ ENGRAM_GUARDED_BY(mutex_) = 0;
  bool is_writing_ ENGRAM_GUARDED_BY(mutex_) = false;
  bool is_reading_ ENGRAM_GUARDED_BY(mutex_) = false;
  bool is_read_to_end_ ENGRAM_GUARDED_BY(mutex_) = false;
  bool is_broken_ ENGRAM_GUARDED_BY(mutex_) = false;
  bool is_finished_ ENGRAM_GUARDED_BY(mutex_) = false;
  Status status_ ENGRAM_GUARDED_BY(mutex_);
};

}  // namespace engram::server
