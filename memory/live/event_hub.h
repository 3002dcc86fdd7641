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

/// What is told to subscribers: one snapshot of a commit, and what is made of it once for all of
/// them, such as the bytes that are sent.
class CommitEvent {
 public:
  explicit CommitEvent(ltm::SharedSnapshot committed) : snapshot(std::move(committed)) {}
  virtual ~CommitEvent() = default;

  ltm::SharedSnapshot snapshot;
};

using SharedEvent = std::shared_ptr<CommitEvent>;

/// Somebody who is told of commits.
class EventListener {
 public:
  virtual ~EventListener() = default;

  /// Called in the thread of who commits: queues, and does not wait.
  /// Threading: thread-safe.
  virtual void offer(std::span<const SharedEvent> events) = 0;
};

/// Tells commits to those who subscribed to the IDs in them.
///
/// Threading: thread-safe.
class EventHub {
 public:
  using Listeners = std::vector<std::shared_ptr<EventListener>>;

  /// Whether it wants to know of an entity; asked once for each, and again when others come or go.
  using Wanted = std::function<bool(const ltm::MemoryId& entity)>;

  void subscribe(std::shared_ptr<EventListener> listener, Wanted is_wanted);
  /// It may still be offered what is published at this moment.
  void unsubscribe(const EventListener* listener);

  /// Who listens to this entity; null where nobody does.
  /// Complexity: O(1) for an entity that was asked for before, else O(listeners).
  [[nodiscard]] std::shared_ptr<const Listeners> listeners(const ltm::MemoryId& entity);

  /// Offers each listener those of the events that it wants, in their order. `make` turns a
  /// snapshot into an event; called where somebody listens.
  template <typename Make>
  void publish(std::span<const ltm::SharedSnapshot> snapshots, const Make& make);

  [[nodiscard]] size_t size() const;

 private:
  struct Subscription {
    std::shared_ptr<EventListener> listener;
    Wanted is_wanted;
  };

  mutable SharedMutex mutex_;
  std::vector<Subscription> subscriptions_ ENGRAM_GUARDED_BY(mutex_);
  /// Of entities that were published; emptied when subscriptions change or it grows too large.
  std::unordered_map<ltm::MemoryId, std::shared_ptr<const Listeners>> by_entity_
      ENGRAM_GUARDED_BY(mutex_);
};

template <typename Make>
void EventHub::publish(std::span<const ltm::SharedSnapshot> snapshots, const Make& make) {
  // Most commits are of entities that the same listeners want: runs of those are offered at once.
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
