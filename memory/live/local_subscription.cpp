// SPDX-License-Identifier: Apache-2.0
#include "memory/live/local_subscription.h"

#include <thread>

#include "ltm/core/mutex.h"
#include "memory/live/event_queue.h"

namespace engram::memory {

namespace {

/// The memory of an event besides its values. Unit: bytes.
constexpr size_t kEventBytes = 256;

/// Queues what commits offer, so that commits wait for no handler.
class QueueingListener final : public EventListener {
 public:
  QueueingListener(const SubscriptionOptions& options, SubscriptionHandlers handlers)
      : options_(options), handlers_(std::move(handlers)), queue_(bounds(options)) {}

  void offer(std::span<const SharedEvent> events) override {
    const MutexLock lock(mutex_);
    for (const SharedEvent& event : events)
      queue_.push(event->snapshot, kEventBytes + event->snapshot->plain_bytes());
    wake_.notify_one();
  }

  /// Loses nothing until settle().
  void widen() {
    const MutexLock lock(mutex_);
    queue_.widen({.events = SIZE_MAX, .bytes = SIZE_MAX});
  }
  void settle() {
    const MutexLock lock(mutex_);
    queue_.settle();
  }

  void forget(const IsForgotten& is_forgotten) override {
    const MutexLock lock(mutex_);
    queue_.erase_if([&](const ltm::SharedSnapshot& snapshot) { return is_forgotten(*snapshot); });
  }

  /// Calls the handlers until it is stopped.
  void tell(const std::stop_token& stop) {
    uint64_t told_lost = 0;
    while (!stop.stop_requested()) {
      std::vector<ltm::SharedSnapshot> snapshots;
      uint64_t lost = 0;
      {
        const MutexLock lock(mutex_);
        if (!wake_.wait(mutex_, stop, [this]() ENGRAM_REQUIRES(mutex_) { return !queue_.empty(); }))
          return;
        while (!queue_.empty()) snapshots.push_back(queue_.pop());
        lost = queue_.lost() - told_lost;
        told_lost += lost;
      }
      if (lost > 0 && handlers_.on_lost) handlers_.on_lost(lost);
      std::vector<ToldSnapshot> told;
      for (const ltm::SharedSnapshot& snapshot : snapshots) told.push_back(told_of(*snapshot));
      if (handlers_.on_snapshots) handlers_.on_snapshots(std::move(told));
    }
  }

 private:
  static EventQueue<ltm::SharedSnapshot>::Bounds bounds(const SubscriptionOptions& options) {
    EventQueue<ltm::SharedSnapshot>::Bounds bounds;
    if (options.queue_bound > 0) bounds.events = options.queue_bound;
    return bounds;
  }

  [[nodiscard]] ToldSnapshot told_of(const ltm::HeldSnapshot& held) const {
    ToldSnapshot told{{held.entity, held.time, {}}, options_.with_data};
    if (options_.inline_bytes > 0 && held.plain_bytes() > options_.inline_bytes)
      told.has_data = false;
    if (told.has_data)
      told.snapshot.instances = held.instances;
    else
      told.snapshot.instances.resize(held.instances.size());
    return told;
  }

  const SubscriptionOptions options_;
  const SubscriptionHandlers handlers_;
  Mutex mutex_;
  StoppableCondition wake_;
  EventQueue<ltm::SharedSnapshot> queue_ ENGRAM_GUARDED_BY(mutex_);
};

class LocalSubscription final : public Subscription {
 public:
  LocalSubscription(std::shared_ptr<EventHub> hub, std::shared_ptr<QueueingListener> listener,
                    ltm::Query names)
      : hub_(std::move(hub)), listener_(std::move(listener)) {
    hub_->subscribe(listener_, [names = std::move(names)](const ltm::MemoryId& entity) {
      return names.matches(entity);
    });
    thread_ = std::jthread([told = listener_](const std::stop_token& stop) { told->tell(stop); });
  }
  LocalSubscription(const LocalSubscription&) = delete;
  LocalSubscription& operator=(const LocalSubscription&) = delete;
  ~LocalSubscription() override { hub_->unsubscribe(listener_.get()); }

 private:
  const std::shared_ptr<EventHub> hub_;
  const std::shared_ptr<QueueingListener> listener_;
  std::jthread thread_;  ///< Ends before the other members.
};

}  // namespace

Result<std::unique_ptr<Subscription>> subscribe_locally(std::shared_ptr<EventHub> hub,
                                                        const SubscriptionOptions& options,
                                                        SubscriptionHandlers handlers,
                                                        const std::function<void()>& begin) {
  ENGRAM_ASSIGN_OR_RETURN(ltm::Query names, subscribed_names(options.names));
  auto listener = std::make_shared<QueueingListener>(options, std::move(handlers));
  if (begin) listener->widen();
  std::unique_ptr<Subscription> subscription =
      std::make_unique<LocalSubscription>(std::move(hub), listener, std::move(names));
  if (begin) begin();
  listener->settle();
  return subscription;
}

}  // namespace engram::memory
