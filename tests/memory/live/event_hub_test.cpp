// SPDX-License-Identifier: Apache-2.0
#include "memory/live/event_hub.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <mutex>
#include <thread>

namespace engram::memory {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

ltm::SharedSnapshot snapshot(const std::string& entity, int64_t at) {
  return ltm::hold_untyped({*ltm::MemoryId::parse(entity), time_from_ns(at), {{int64_t{1}, {}}}});
}

/// Remembers what it is told.
class Listener final : public EventListener {
 public:
  void offer(std::span<const SharedEvent> events) override {
    const std::scoped_lock lock(mutex_);
    ++offers_;
    for (const SharedEvent& event : events) times_.push_back(to_ns(event->snapshot->time));
  }

  void forget(const IsForgotten& is_forgotten) override {
    const std::scoped_lock lock(mutex_);
    std::erase_if(times_, [&](int64_t at) { return is_forgotten(*snapshot("M/a/b/c", at)); });
  }

  [[nodiscard]] std::vector<int64_t> times() const {
    const std::scoped_lock lock(mutex_);
    return times_;
  }
  [[nodiscard]] int offers() const {
    const std::scoped_lock lock(mutex_);
    return offers_;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<int64_t> times_;
  int offers_ = 0;
};

EventHub::Wanted memory(const std::string& name) {
  return [name](const ltm::MemoryId& entity) { return entity.names()[0] == name; };
}

EventHub::Wanted everything() {
  return [](const ltm::MemoryId& /*entity*/) { return true; };
}

/// Publishes, and says how many events were made.
int publish(EventHub& hub, const std::vector<ltm::SharedSnapshot>& snapshots) {
  int made = 0;
  hub.publish(snapshots, [&made](const ltm::SharedSnapshot& one) {
    ++made;
    return std::make_shared<CommitEvent>(one);
  });
  return made;
}

TEST(EventHub, MakesNoEventsForNobody) {
  EventHub hub;
  EXPECT_EQ(publish(hub, {snapshot("A/b/c/d", 1)}), 0);
}

TEST(EventHub, TellsEachWhatItWants) {
  EventHub hub;
  const auto all = std::make_shared<Listener>();
  const auto some = std::make_shared<Listener>();
  hub.subscribe(all, everything());
  hub.subscribe(some, memory("B"));
  publish(hub, {snapshot("A/b/c/d", 1), snapshot("B/b/c/d", 2), snapshot("A/b/c/e", 3),
                snapshot("B/b/c/d", 4)});
  EXPECT_THAT(all->times(), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(some->times(), ElementsAre(2, 4));
}

TEST(EventHub, OffersRunsAtOnce) {
  EventHub hub;
  const auto listener = std::make_shared<Listener>();
  hub.subscribe(listener, everything());
  std::vector<ltm::SharedSnapshot> many;
  for (int i = 0; i < 100; ++i) many.push_back(snapshot(fmt::format("A/b/c/d{}", i % 7), i));
  EXPECT_EQ(publish(hub, many), 100);
  EXPECT_EQ(listener->offers(), 1);
}

TEST(EventHub, TellsNoMoreAfterTheEnd) {
  EventHub hub;
  const auto listener = std::make_shared<Listener>();
  hub.subscribe(listener, everything());
  publish(hub, {snapshot("A/b/c/d", 1)});
  hub.unsubscribe(listener.get());
  hub.unsubscribe(listener.get());
  publish(hub, {snapshot("A/b/c/d", 2)});
  EXPECT_THAT(listener->times(), ElementsAre(1));
  EXPECT_EQ(hub.size(), 0u);
  EXPECT_EQ(listener.use_count(), 1);
}

TEST(EventHub, TellsThoseWhoCameLaterOfEntitiesThatAreKnown) {
  EventHub hub;
  const auto first = std::make_shared<Listener>();
  hub.subscribe(first, memory("B"));
  publish(hub, {snapshot("A/b/c/d", 1)});
  const auto second = std::make_shared<Listener>();
  hub.subscribe(second, memory("A"));
  publish(hub, {snapshot("A/b/c/d", 2)});
  EXPECT_THAT(first->times(), IsEmpty());
  EXPECT_THAT(second->times(), ElementsAre(2));
}

TEST(EventHub, LosesNothingWhileOthersComeAndGo) {
  EventHub hub;
  const auto steady = std::make_shared<Listener>();
  hub.subscribe(steady, everything());
  constexpr int kWriters = 3;
  constexpr int kEach = 2000;
  std::atomic<bool> is_over{false};
  {
    std::vector<std::jthread> comers;
    for (int t = 0; t < 2; ++t)
      comers.emplace_back([&] {
        while (!is_over) {
          const auto listener = std::make_shared<Listener>();
          hub.subscribe(listener, memory("A"));
          std::this_thread::yield();
          hub.unsubscribe(listener.get());
        }
      });
    {
      std::vector<std::jthread> writers;
      for (int t = 0; t < kWriters; ++t)
        writers.emplace_back([&hub, t] {
          for (int i = 0; i < kEach; ++i)
            publish(hub, {snapshot(fmt::format("{}/b/c/d{}", i % 2 == 0 ? "A" : "B", t), i)});
        });
    }
    is_over = true;
  }
  EXPECT_EQ(steady->times().size(), size_t{kWriters} * kEach);
  EXPECT_EQ(hub.size(), 1u);
}

TEST(EventHub, ListenersLetGoOfWhatWasForgotten) {
  EventHub hub;
  const auto listener = std::make_shared<Listener>();
  hub.subscribe(listener, everything());
  const std::vector<ltm::SharedSnapshot> told{snapshot("M/a/b/c", 1), snapshot("M/a/b/c", 2),
                                              snapshot("M/a/b/c", 3)};
  hub.publish(told,
              [](const ltm::SharedSnapshot& one) { return std::make_shared<CommitEvent>(one); });
  hub.forget([](const ltm::HeldSnapshot& one) { return to_ns(one.time) == 2; });
  EXPECT_THAT(listener->times(), ElementsAre(1, 3));
}

}  // namespace
}  // namespace engram::memory
