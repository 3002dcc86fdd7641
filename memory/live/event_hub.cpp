// SPDX-License-Identifier: Apache-2.0
#include "memory/live/event_hub.h"

#include <algorithm>

namespace engram::memory {

namespace {

/// The bound of entities whose listeners are remembered.
constexpr size_t kRemembered = size_t{1} << 16;

}  // namespace

void EventHub::subscribe(std::shared_ptr<EventListener> listener, Wanted is_wanted) {
  add({std::move(listener), std::move(is_wanted)});
}

void EventHub::subscribe_uncounted(std::shared_ptr<EventListener> listener, Wanted is_wanted) {
  add({std::move(listener), std::move(is_wanted), false});
}

void EventHub::add(Subscription subscription) {
  const ExclusiveLock lock(mutex_);
  subscriptions_.push_back(std::move(subscription));
  by_entity_.clear();
}

void EventHub::unsubscribe(const EventListener* listener) {
  const ExclusiveLock lock(mutex_);
  std::erase_if(subscriptions_, [listener](const Subscription& subscription) {
    return subscription.listener.get() == listener;
  });
  by_entity_.clear();
}

std::shared_ptr<const EventHub::Listeners> EventHub::listeners(const ltm::MemoryId& entity) {
  {
    const SharedLock lock(mutex_);
    if (subscriptions_.empty()) return nullptr;
    if (const auto known = by_entity_.find(entity); known != by_entity_.end()) return known->second;
  }
  const ExclusiveLock lock(mutex_);
  auto found = std::make_shared<Listeners>();
  for (const Subscription& subscription : subscriptions_)
    if (subscription.is_wanted(entity)) found->push_back(subscription.listener);
  if (by_entity_.size() >= kRemembered) by_entity_.clear();
  auto& remembered = by_entity_[entity];
  remembered = found->empty() ? nullptr : std::move(found);
  return remembered;
}

void EventHub::forget(const IsForgotten& is_forgotten) {
  Listeners all;
  {
    // Listeners are called without the lock, as publish() calls them.
    const SharedLock lock(mutex_);
    for (const Subscription& subscription : subscriptions_) all.push_back(subscription.listener);
  }
  for (const auto& listener : all) listener->forget(is_forgotten);
}

size_t EventHub::size() const {
  const SharedLock lock(mutex_);
  return static_cast<size_t>(std::ranges::count_if(subscriptions_, &Subscription::is_counted));
}

}  // namespace engram::memory
