// SPDX-License-Identifier: Apache-2.0
#include "server/client/remote_subscription.h"

#include <engram/v1/memory.pb.h>

#include <thread>

#include "ltm/core/log.h"
#include "ltm/core/mutex.h"
#include "server/client/client_stream.h"
#include "server/wire/byte_message.h"
#include "server/wire/polling_threads.h"
#include "server/wire/wire_snapshot.h"

namespace engram::server {

namespace {

/// The interval at which the server is told which blocks are no longer read.
constexpr auto kReleaseEvery = std::chrono::milliseconds(20);
constexpr auto kAgainAfter = std::chrono::milliseconds(100);

class RemoteSubscription final : public Subscription {
 public:
  RemoteSubscription(std::shared_ptr<grpc::Channel> channel, ClientOptions client,
                     const SubscriptionOptions& options, SubscriptionHandlers handlers,
                     LaneSource lanes)
      : channel_(std::move(channel)),
        client_(std::move(client)),
        handlers_(std::move(handlers)),
        lanes_(options.with_data ? std::move(lanes) : LaneSource()) {
    for (const std::string& names : options.names) request_.add_names(names);
    request_.set_with_data(options.with_data);
    request_.set_inline_bytes(static_cast<uint32_t>(options.inline_bytes));
    request_.set_queue_bound(static_cast<uint32_t>(options.queue_bound));
  }

  ~RemoteSubscription() override {
    {
      const MutexLock lock(mutex_);
      is_ending_ = true;
    }
    changed_.notify_all();
    if (thread_.joinable()) thread_.join();
    if (stream_) stream_->cancel();
    stream_.reset();
    streams_.wait();
  }

  /// Opens the stream and waits until the server confirms that the subscription has begun.
  Status begin() {
    const BlockingScope blocking;
    open();
    keep_alive();
    const MutexLock lock(mutex_);
    const bool is_told = changed_.wait_for(
        mutex_, client_.timeout,
        [this]() ENGRAM_REQUIRES(mutex_) { return is_started_ || !is_lasting_.ok(); });
    if (!is_lasting_.ok()) return is_lasting_;
    if (!is_told)
      return unavailable("subscription: no answer within {}", to_string(client_.timeout));
    return {};
  }

 private:
  /// Starts the thread that reopens the stream after it broke and gives blocks back.
  void keep_alive() {
    thread_ = std::thread([this] {
      MutexLock lock(mutex_);
      while (!is_ending_) {
        const bool is_due = changed_.wait_for(
            mutex_, kReleaseEvery,
            [this]() ENGRAM_REQUIRES(mutex_) { return is_ending_ || open_streams_ == 0; });
        if (is_ending_) return;
        if (!is_due) {
          const auto stream = stream_;
          lock.unlock();
          release(stream);
          lock.lock();
          continue;
        }
        if (changed_.wait_for(mutex_, kAgainAfter,
                              [this]() ENGRAM_REQUIRES(mutex_) { return is_ending_; }))
          return;
        lock.unlock();
        open();
        lock.lock();
      }
    });
  }

  void open() ENGRAM_EXCLUDES(mutex_) {
    {
      const MutexLock lock(mutex_);
      ++open_streams_;
      lost_ = 0;
      is_telling_ = false;
    }
    auto lane = lanes_ ? lanes_() : nullptr;
    v1::SubscribeRequest request = request_;
    request.set_with_shared_memory(lane != nullptr);
    {
      const MutexLock lock(mutex_);
      lane_ = lane;
    }
    auto stream =
        ClientStream::open(channel_, "/engram.v1.MemoryServer/Subscribe", client_.token, streams_,
                           {[this](grpc::ByteBuffer& bytes) { take(bytes); },
                            [this](const Status& status) { end(status); }},
                           lane ? lane->session() : "");
    {
      const MutexLock lock(mutex_);
      stream_ = stream;
    }
    // If the stream has already ended, end() is called and the stream is opened again.
    if (const Status status = stream->send(to_bytes(request)); !status.ok())
      log::debug("subscription: {}", status.message());
  }

  void take(grpc::ByteBuffer& bytes) {
    v1::Notification notification;
    if (!read_message(bytes, notification).ok()) return;
    if (notification.is_started()) {
      {
        const MutexLock lock(mutex_);
        is_started_ = true;
        is_telling_ = true;
      }
      changed_.notify_all();
      return;
    }
    if (notification.lost() > lost_) {
      if (handlers_.on_lost) handlers_.on_lost(notification.lost() - lost_);
      lost_ = notification.lost();
    }
    std::vector<ToldSnapshot> told;
    told.reserve(static_cast<size_t>(notification.events_size()));
    uint64_t block_generation = 0;
    Buffer block;
    for (v1::Snapshot& event : *notification.mutable_events()) {
      const bool has_data = event.instances_size() > 0 &&
                            (!event.instances(0).data().empty() || event.instances(0).has_shared());
      if (event.has_block() && event.block().generation() != block_generation) {
        // All events of a message that lie in one block share one lease of it.
        block = readable(to_block(event.block()));
        block_generation = event.block().generation();
      }
      auto snapshot = take_snapshot(event, event.has_block() ? block : Buffer());
      if (snapshot.ok()) told.push_back({*std::move(snapshot), has_data});
    }
    block = {};
    if (!told.empty() && handlers_.on_snapshots) handlers_.on_snapshots(std::move(told));
  }

  /// Maps a block. Returns an empty buffer if it cannot be mapped: its snapshots are then
  /// unreadable.
  Buffer readable(const BlockRef& block) {
    std::shared_ptr<SharedLane> lane;
    {
      const MutexLock lock(mutex_);
      lane = lane_;
    }
    if (!lane) return {};
    auto bytes =
        lane->memory().readable(block, block.capacity, [list = released_](const BlockRef& gone) {
          const MutexLock lock(list->mutex);
          list->blocks.push_back(gone);
        });
    return bytes.ok() ? *std::move(bytes) : Buffer();
  }

  /// Tells the server which blocks are no longer read.
  void release(const std::shared_ptr<ClientStream>& stream) {
    std::vector<BlockRef> blocks;
    {
      const MutexLock lock(released_->mutex);
      blocks.swap(released_->blocks);
    }
    if (blocks.empty() || !stream) return;
    v1::SubscribeRequest request;
    for (const BlockRef& block : blocks) *request.add_released() = to_message(block);
    // Ignoring the failure is safe: the server takes back all blocks of a client whose stream
    // ended.
    if (const Status status = stream->send(to_bytes(request)); !status.ok())
      log::debug("subscription: {} blocks not given back: {}", blocks.size(), status.message());
  }

  void end(const Status& status) ENGRAM_EXCLUDES(mutex_) {
    bool is_loss = false;
    {
      const MutexLock lock(mutex_);
      if (!is_started_ && status.code() != StatusCode::kUnavailable) is_lasting_ = status;
      // An interruption is reported once, since all snapshots between the loss and the next
      // beginning are lost anyway.
      is_loss = is_telling_ && !is_ending_;
    }
    if (is_loss && handlers_.on_interrupted) handlers_.on_interrupted(status);
    const MutexLock lock(mutex_);
    --open_streams_;
    changed_.notify_all();
  }

  const std::shared_ptr<grpc::Channel> channel_;
  const ClientOptions client_;
  const SubscriptionHandlers handlers_;
  const LaneSource lanes_;
  /// Blocks that are no longer read. The list is shared because buffers may outlive the
  /// subscription.
  struct Released {
    Mutex mutex;
    std::vector<BlockRef> blocks ENGRAM_GUARDED_BY(mutex);
  };
  const std::shared_ptr<Released> released_ = std::make_shared<Released>();
  v1::SubscribeRequest request_;
  uint64_t lost_ = 0;  ///< Used only by the thread that runs the stream's handlers.

  OpenStreams streams_;
  Mutex mutex_;
  ConditionVariable changed_;
  std::shared_ptr<ClientStream> stream_ ENGRAM_GUARDED_BY(mutex_);
  std::shared_ptr<SharedLane> lane_ ENGRAM_GUARDED_BY(mutex_);
  int open_streams_ ENGRAM_GUARDED_BY(mutex_) = 0;
  bool is_started_ ENGRAM_GUARDED_BY(mutex_) = false;  ///< Confirmed on any stream so far.
  bool is_telling_ ENGRAM_GUARDED_BY(mutex_) = false;  ///< Confirmed on the current stream.
  bool is_ending_ ENGRAM_GUARDED_BY(mutex_) = false;
  /// The permanent error because of which the subscription cannot begin.
  Status is_lasting_ ENGRAM_GUARDED_BY(mutex_);
  std::thread thread_;
};

}  // namespace

Result<std::unique_ptr<Subscription>> subscribe_remotely(std::shared_ptr<grpc::Channel> channel,
                                                         const ClientOptions& client,
                                                         const SubscriptionOptions& options,
                                                         SubscriptionHandlers handlers,
                                                         LaneSource lane) {
  auto subscription = std::make_unique<RemoteSubscription>(std::move(channel), client, options,
                                                           std::move(handlers), std::move(lane));
  ENGRAM_RETURN_IF_ERROR(subscription->begin());
  return std::unique_ptr<Subscription>(std::move(subscription));
}

}  // namespace engram::server
