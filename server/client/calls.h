// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: sends requests on a stream and matches each reply to its request.

#include <grpcpp/channel.h>

#include <functional>
#include <map>
#include <memory>
#include <string>

#include "ltm/core/mutex.h"
#include "server/client/client_stream.h"
#include "server/wire/byte_message.h"

namespace engram::server {

/// One kind of stream of a client. It is opened with the first request, and opened again with the
/// next request after it has ended. Replies are matched to requests by number.
/// Threading: thread-safe; handlers run on gRPC's threads.
template <typename Reply>
class Calls : public std::enable_shared_from_this<Calls<Reply>> {
 public:
  /// What is called for one request. `on_reply` returns true if that reply was the last one of its
  /// request; exactly one of the two then ends the request.
  struct Pending {
    std::function<bool(Reply&)> on_reply;
    std::function<void(const Status&)> on_failure;
  };

  Calls(std::shared_ptr<grpc::Channel> channel, std::string method, std::string token,
        std::string session = {})
      : channel_(std::move(channel)),
        method_(std::move(method)),
        token_(std::move(token)),
        session_(std::move(session)) {}

  /// Sends a request. `make` builds the message for the number that this call assigns.
  template <typename Make>
  void call(const Make& make, Pending pending) {
    std::shared_ptr<ClientStream> stream;
    uint64_t number = 0;
    {
      const MutexLock lock(mutex_);
      if (!stream_ || !stream_->is_open()) open();
      stream = stream_;
      number = ++numbers_;
      pending_.emplace(number, std::pair(generation_, std::move(pending)));
    }
    const Status sent = stream->send(make(number));
    if (!sent.ok()) fail_one(number, sent);
  }

  /// Drops a request that nobody waits for any more; a late reply to it is ignored.
  void forget(uint64_t number) ENGRAM_EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    pending_.erase(number);
  }

  /// Cancels the stream and waits until every stream of this object is destroyed.
  void close() {
    std::shared_ptr<ClientStream> stream;
    {
      const MutexLock lock(mutex_);
      stream = std::move(stream_);
    }
    if (stream) stream->cancel();
    stream.reset();
    streams_.wait();
  }

 private:
  void open() ENGRAM_REQUIRES(mutex_) {
    const uint64_t generation = ++generation_;
    const std::weak_ptr<Calls> weak = this->weak_from_this();
    stream_ = ClientStream::open(channel_, method_, token_, streams_,
                                 {[weak](grpc::ByteBuffer& bytes) {
                                    if (const auto self = weak.lock()) self->take(bytes);
                                  },
                                  [weak, generation](const Status& status) {
                                    if (const auto self = weak.lock())
                                      self->fail_all(generation, status);
                                  }},
                                 session_);
  }

  void take(grpc::ByteBuffer& bytes) {
    Reply reply;
    // A reply that cannot be parsed has no usable number, so its request fails by its timeout.
    if (!read_message(bytes, reply).ok()) return;
    Pending pending;
    {
      const MutexLock lock(mutex_);
      const auto found = pending_.find(reply.number());
      if (found == pending_.end()) return;
      pending = found->second.second;
    }
    if (pending.on_reply(reply)) forget(reply.number());
  }

  void fail_one(uint64_t number, const Status& status) ENGRAM_EXCLUDES(mutex_) {
    Pending failed;
    {
      const MutexLock lock(mutex_);
      const auto found = pending_.find(number);
      if (found == pending_.end()) return;
      failed = std::move(found->second.second);
      pending_.erase(found);
    }
    failed.on_failure(status);
  }

  void fail_all(uint64_t generation, const Status& status) ENGRAM_EXCLUDES(mutex_) {
    std::vector<Pending> failed;
    {
      const MutexLock lock(mutex_);
      for (auto one = pending_.begin(); one != pending_.end();) {
        if (one->second.first > generation) {
          ++one;
          continue;
        }
        failed.push_back(std::move(one->second.second));
        one = pending_.erase(one);
      }
    }
    for (const Pending& one : failed) one.on_failure(status);
  }

  const std::shared_ptr<grpc::Channel> channel_;
  const std::string method_;
  const std::string token_;
  const std::string session_;
  OpenStreams streams_;
  Mutex mutex_;
  std::shared_ptr<ClientStream> stream_ ENGRAM_GUARDED_BY(mutex_);
  uint64_t generation_ ENGRAM_GUARDED_BY(mutex_) = 0;
  uint64_t numbers_ ENGRAM_GUARDED_BY(mutex_) = 0;
  std::map<uint64_t, std::pair<uint64_t, Pending>> pending_ ENGRAM_GUARDED_BY(mutex_);
};

}  // namespace engram::server
