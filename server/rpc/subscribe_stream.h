// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/server_callback.h>

#include <atomic>
#include <optional>

#include "ltm/core/mutex.h"
#include "memory/live/event_queue.h"
#include "server/rpc/rpc_context.h"
#include "server/rpc/wire_event.h"

namespace engram::server {

/// The stream that sends commits to one subscriber as fast as it reads. If the subscriber is too
/// slow, the oldest snapshots are dropped and the subscriber is told how many.
class SubscribeStream final : public grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>,
                              public memory::EventListener,
                              public std::enable_shared_from_this<SubscribeStream> {
 public:
  SubscribeStream(RpcContext& context, Identity who, ClientId sharing)
      : context_(context), who_(std::move(who)), sharing_(sharing) {}

  void begin();

  void offer(std::span<const memory::SharedEvent> events) override;
  void forget(const memory::IsForgotten& is_forgotten) override;

  void OnReadDone(bool ok) override;
  void OnWriteDone(bool ok) override;
  void OnCancel() override;
  void OnDone() override;

 private:
  Status start(const v1::SubscribeRequest& request) ENGRAM_EXCLUDES(mutex_);
  [[nodiscard]] bool may_have_data(const ltm::HeldSnapshot& snapshot) const;
  [[nodiscard]] bool may_see(const ltm::HeldSnapshot& snapshot) const;
  [[nodiscard]] const WireBytes& form_of(WireEvent& event) const;
  /// The size of an event in a message.
  [[nodiscard]] size_t told_bytes(WireEvent& event) const;
  /// The memory that an event occupies while it waits.
  [[nodiscard]] size_t kept_bytes(const WireEvent& event) const;
  /// The event as a reference to shared memory; null unless its data are there, are large, and the
  /// subscriber may read them.
  [[nodiscard]] const WireBytes* shared_form_of(WireEvent& event, uint64_t& last_shared) const;
  void write_next() ENGRAM_REQUIRES(mutex_);
  void finish(const Status& status) ENGRAM_EXCLUDES(mutex_);

  RpcContext& context_;
  const Identity who_;
  const ltm::SharedView view_ = who_.view();  ///< Null: everything.
  const ClientId sharing_;                    ///< kServerItself if it shares no memory.
  const StreamSlot slot_{context_, who_};
  std::shared_ptr<SubscribeStream> self_;
  grpc::ByteBuffer request_;
  bool is_started_ = false;  ///< Needs no lock, because requests come one at a time.
  bool with_data_ = false;
  bool with_shared_memory_ = false;
  size_t inline_bytes_ = SIZE_MAX;

  Mutex mutex_;
  std::optional<memory::EventQueue<memory::SharedEvent>> queue_ ENGRAM_GUARDED_BY(mutex_);
  grpc::ByteBuffer written_ ENGRAM_GUARDED_BY(mutex_);
  /// To the sensory entities among those that are wanted.
  memory::Attention attention_ ENGRAM_GUARDED_BY(mutex_);
  bool is_writing_ ENGRAM_GUARDED_BY(mutex_) = false;
  bool is_finished_ ENGRAM_GUARDED_BY(mutex_) = false;
};

}  // namespace engram::server
