// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include "ltm/core/mutex.h"
#include "ltm/memory/memory_id.h"
#include "ltm/working/held_snapshot.h"

namespace engram::memory {

/// What subscribers are told: one snapshot of a commit. Subclasses add what is computed once for
/// all subscribers, such as the bytes that are sent.
class CommitEvent {
 public:
  explicit CommitEvent(ltm::SharedSnapshot committed) : snapshot(std::move(committed)) {}
  virtual ~CommitEvent() = default;

  ltm::SharedSnapshot snapshot;
};

using SharedEvent = std::shared_ptr<CommitEvent>;

/// Whether a snapshot was forgotten.
using IsForgotten = std::function<bool(const ltm::HeldSnapshot& snapshot)>;

/// A receiver of commits.
class EventListener {
 public:
  virtual ~EventListener() = default;

  /// Must queue the events and not wait, because it is called in the thread that commits.
  /// Threading: thread-safe.
  virtual void offer(std::span<const SharedEvent> events) = 0;

  /// Must drop what was offered, is among these and was not passed on yet.
  /// Threading: thread-safe.
  virtual void forget(const IsForgotten& is_forgotten) = 0;
};

/// Offers commits to the listeners that subscribed to their IDs.
///
/// Threading: thread-safe.
class EventHub {
 public:
  using Listeners = std::vector<std::shared_ptr<EventListener>>;

  /// Whether a listener wants an entity. The answer is remembered until a subscription changes.
  using Wanted = std::function<bool(const ltm::MemoryId& entity)>;

  void subscribe(std::shared_ptr<EventListener> listener, Wanted is_wanted);
  /// The same for a part of the server itself, which size() leaves out.
  void subscribe_uncounted(std::shared_ptr<EventListener> listener, Wanted is_wanted);
  /// The listener may still be offered what is being published at this moment.
  void unsubscribe(const EventListener* listener);

  /// The listeners of this entity; null where there are none.
  /// Complexity: O(1) for an entity that was asked for before, otherwise O(listeners).
  [[nodiscard]] std::shared_ptr<const Listeners> listeners(const ltm::MemoryId& entity);

  /// Offers each listener the events that it wants, in their order. `make` turns a snapshot into an
  /// event; it is called only for snapshots that have listeners.
  template <typename Make>
  void publish(std::span<const ltm::SharedSnapshot> snapshots, const Make& make);

  /// Lets all listeners drop what was forgotten before they passed it on.
  void forget(const IsForgotten& is_forgotten);

  /// The number of subscribers.
  [[nodiscard]] size_t size() const;

 private:
  struct Subscription {
    std::shared_ptr<EventListener> listener;
    Wanted is_wanted;
    bool is_counted = true;
  };

  void add(Subscription subscription);

  mutable SharedMutex mutex_;
  std::vector<Subscription> subscriptions_ ENGRAM_GUARDED_BY(mutex_);
  /// The listeners of entities that were published. Cleared when subscriptions change or it grows
  /// too large.
  std::unordered_map<ltm::MemoryId, std::shared_ptr<const Listeners>> by_entity_
      ENGRAM_GUARDED_BY(mutex_);
};

template <typename Make>
void EventHub::publish(std::span<const ltm::SharedSnapshot> snapshots, const Make& make) {
  // Most commits hold entities with the same listeners: runs of these are offered at once.
  std::vector<SharedEvent> run;
  std::shared_ptr<const Listeners> who;
  const auto offer = [&] {
    if (who)
      for (const auto& listener : *who) listener->offer(run);
    run.clear();
  };
  for (const ltm::SharedSnapshot& snapshot : snapshots) {
    auto listening = listeners(snapshot->entity);
    if (!run.empty() && listening != who && !(listening && who && *listening == *who)) offer();
    who = std::move(listening);
    if (who) run.push_back(make(snapshot));
  }
  if (!run.empty()) offer();
}

}  // namespace engram::memory
