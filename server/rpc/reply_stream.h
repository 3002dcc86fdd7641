// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/server_callback.h>

#include <deque>
#include <memory>

#include "ltm/core/mutex.h"
#include "ltm/core/status.h"

namespace engram::server {

/// The server's end of a stream of requests and replies, as bytes. Requests are read one at a time,
/// and none is read while too many replies wait. A client that does not read its replies is thus
/// slowed down and costs bounded memory.
///
/// Threading: thread-safe; on_request() is called by one thread at a time.
class ReplyStream : public grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>,
                    public std::enable_shared_from_this<ReplyStream> {
 public:
  /// From this many waiting replies on, no further request is read.
  static constexpr size_t kMaxReplies = 256;
  static constexpr size_t kMaxReplyBytes = size_t{16} << 20;

  /// Starts the stream, which keeps itself alive until it has ended.
  void begin();

  void OnReadDone(bool ok) final;
  void OnWriteDone(bool ok) final;
  void OnCancel() final;
  void OnDone() final;

 protected:
  /// Handles a request: sends the reply, or calls promise() and sends it later. An error ends the
  /// stream.
  virtual Status on_request(grpc::ByteBuffer& request) = 0;
  /// Called when the stream has ended; nothing can be sent any more.
  virtual void on_end() {}
  /// Called after a reply was written; has_room() may be true now.
  virtual void on_sent() {}

  /// Whether few enough replies wait, of less than `max_bytes`, that more should be made.
  [[nodiscard]] bool has_room(size_t max_bytes = kMaxReplyBytes) ENGRAM_EXCLUDES(mutex_);

  /// Adds or removes one reply that will come later. The stream does not end while replies are
  /// promised.
  void promise() ENGRAM_EXCLUDES(mutex_);
  void fulfil() ENGRAM_EXCLUDES(mutex_);

  void send(grpc::ByteBuffer reply) ENGRAM_EXCLUDES(mutex_);
  /// Sends the waiting replies, then ends the stream.
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
