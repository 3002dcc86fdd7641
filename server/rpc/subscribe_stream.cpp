// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/subscribe_stream.h"

#include "memory/live/subscription.h"
#include "server/wire/byte_message.h"
#include "server/wire/wire_block.h"
#include "server/wire/wire_status.h"

namespace engram::server {

namespace {

/// The size up to which events share a message: small ones travel together when a subscriber is
/// behind.
constexpr size_t kMessageBytes = size_t{1} << 20;
constexpr size_t kMaxQueuedEvents = size_t{1} << 20;
constexpr size_t kMaxQueuedBytes = size_t{1} << 30;

}  // namespace

void SubscribeStream::begin() {
  self_ = shared_from_this();
  StartRead(&request_);
}

Status SubscribeStream::start(const v1::SubscribeRequest& request) {
  ENGRAM_ASSIGN_OR_RETURN(ltm::Query names,
                          subscribed_names({request.names().begin(), request.names().end()}));
  ENGRAM_RETURN_IF_ERROR(context_.audited(who_.name(), "subscribe",
                                          fmt::format("{}", fmt::join(request.names(), " ")), {}));
  memory::EventQueue<memory::SharedEvent>::Bounds bounds;
  if (request.queue_bound() > 0)
    bounds.events = std::min<size_t>(request.queue_bound(), kMaxQueuedEvents);
  if (request.queue_bytes() > 0)
    bounds.bytes = std::min<size_t>(request.queue_bytes(), kMaxQueuedBytes);
  with_data_ = request.with_data();
  with_shared_memory_ =
      request.with_shared_memory() && context_.sharing && sharing_ != kServerItself;
  if (request.inline_bytes() > 0) inline_bytes_ = request.inline_bytes();
  v1::Notification started;
  started.set_is_started(true);
  {
    // Every snapshot from here on is sent: it queues behind this message.
    const MutexLock lock(mutex_);
    if (is_finished_) return {};
    queue_.emplace(bounds);
    // What is held passes at once, before any of it can be sent.
    queue_->widen({kMaxQueuedEvents, kMaxQueuedBytes});
    is_writing_ = true;
    written_ = to_bytes(started);
  }
  const auto is_wanted = [names = std::move(names), who = who_](const ltm::MemoryId& entity) {
    return names.matches(entity) && who.check(Right::kRead, entity).ok();
  };
  context_.hub.subscribe(shared_from_this(), is_wanted);
  // What sensory memory holds passes now, and is the first that this subscriber is told.
  memory::Attention attention = context_.service.attend(is_wanted);
  const MutexLock lock(mutex_);
  if (is_finished_) return {};
  attention_ = std::move(attention);
  queue_->settle();
  StartWrite(&written_);
  return {};
}

void SubscribeStream::OnReadDone(bool ok) {
  // A client that has closed its sending side still receives events.
  if (!ok) return;
  v1::SubscribeRequest request;
  Status status = read_message(request_, request);
  request_.Clear();
  if (!status.ok()) context_.metrics.broken_requests.add();
  if (status.ok() && !is_started_) status = start(request);
  if (context_.sharing)
    for (const v1::Block& block : request.released())
      context_.sharing->release(sharing_, to_block(block));
  is_started_ = true;
  if (!status.ok()) {
    finish(status);
    return;
  }
  const MutexLock lock(mutex_);
  if (!is_finished_) StartRead(&request_);
}

const WireBytes& SubscribeStream::form_of(WireEvent& event) const {
  if (!with_data_ || !may_have_data(*event.snapshot)) return event.ids_only();
  const WireBytes& data = event.with_data();
  return data.size <= inline_bytes_ ? data : event.ids_only();
}

size_t SubscribeStream::kept_bytes(const WireEvent& event) const {
  constexpr size_t kEventBytes = 256;
  if (!with_data_) return kEventBytes;
  return kEventBytes + event.snapshot->plain_bytes();
}

size_t SubscribeStream::told_bytes(WireEvent& event) const {
  const WireEvent::Shared* shared =
      with_data_ && with_shared_memory_ && may_have_data(*event.snapshot)
          ? event.shared(context_.sharing->pool())
          : nullptr;
  return shared != nullptr ? shared->bytes.size : form_of(event).size;
}

const WireBytes* SubscribeStream::shared_form_of(WireEvent& event, uint64_t& last_shared) const {
  if (!with_data_ || !with_shared_memory_ || !may_have_data(*event.snapshot)) return nullptr;
  const WireEvent::Shared* shared = event.shared(context_.sharing->pool());
  if (shared == nullptr) return nullptr;
  // All events of a message that lie in one block share one lease.
  if (shared->block.generation == last_shared) return &shared->bytes;
  const std::string& memory = event.snapshot->entity.names()[0];
  if (!context_.sharing->share(shared->block, memory, sharing_).ok()) return nullptr;
  last_shared = shared->block.generation;
  return &shared->bytes;
}

bool SubscribeStream::may_see(const ltm::HeldSnapshot& snapshot) const {
  // The hub remembers who wants an entity, but a token may expire, and may be for some times.
  return !view_ || view_->of(snapshot.entity).times.contains(snapshot.time);
}

/// A detector would take too long for the thread that commits.
bool SubscribeStream::may_have_data(const ltm::HeldSnapshot& snapshot) const {
  return !view_ || view_->of(snapshot.entity).exact.contains(snapshot.time);
}

void SubscribeStream::offer(std::span<const memory::SharedEvent> events) {
  const MutexLock lock(mutex_);
  if (is_finished_) return;
  const uint64_t lost = queue_->lost();
  uint64_t offered = 0;
  for (const memory::SharedEvent& event : events) {
    if (!may_see(*event->snapshot)) continue;
    queue_->push(event, kept_bytes(static_cast<const WireEvent&>(*event)));
    ++offered;
  }
  context_.metrics.events.add(offered);
  if (queue_->lost() > lost) context_.metrics.lost_events.add(queue_->lost() - lost);
  write_next();
}

void SubscribeStream::forget(const memory::IsForgotten& is_forgotten) {
  const MutexLock lock(mutex_);
  if (is_finished_ || !queue_) return;
  queue_->erase_if(
      [&](const memory::SharedEvent& event) { return is_forgotten(*event->snapshot); });
}

void SubscribeStream::write_next() {
  if (is_writing_ || is_finished_ || !queue_ || queue_->empty()) return;
  WireWriter message;
  uint64_t last_shared = 0;
  while (!queue_->empty()) {
    auto& told = static_cast<WireEvent&>(*queue_->next());
    // The token may have expired while it waited.
    if (!may_see(*told.snapshot)) {
      queue_->pop();
      continue;
    }
    if (message.size() > 0 && message.size() + told_bytes(told) > kMessageBytes) break;
    const WireBytes* shared = shared_form_of(told, last_shared);
    message.field(v1::Notification::kEventsFieldNumber, shared ? *shared : form_of(told));
    queue_->pop();
  }
  if (message.size() == 0) return;
  if (queue_->lost() > 0) message.field(v1::Notification::kLostFieldNumber, queue_->lost());
  written_ = message.take().to_byte_buffer();
  is_writing_ = true;
  // The write begins with the lock held, because nothing may begin after Finish().
  StartWrite(&written_);
}

void SubscribeStream::OnWriteDone(bool ok) {
  if (!ok) {
    finish(cancelled("the subscriber is gone"));
    return;
  }
  const MutexLock lock(mutex_);
  is_writing_ = false;
  write_next();
}

void SubscribeStream::OnCancel() {
  finish(cancelled("the subscriber is gone"));
}

void SubscribeStream::finish(const Status& status) {
  context_.hub.unsubscribe(this);
  memory::Attention ended;
  const MutexLock lock(mutex_);
  if (is_finished_) return;
  is_finished_ = true;
  ended = std::move(attention_);
  Finish(to_grpc(status));
}

void SubscribeStream::OnDone() {
  context_.hub.unsubscribe(this);
  self_.reset();
}

}  // namespace engram::server
