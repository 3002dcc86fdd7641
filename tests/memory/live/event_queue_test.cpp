// SPDX-License-Identifier: Apache-2.0
#include "memory/live/event_queue.h"

#include <gtest/gtest.h>

#include <memory>
#include <random>

namespace engram::memory {
namespace {

using Queue = EventQueue<int>;

TEST(EventQueue, GivesEventsInTheirOrder) {
  Queue queue({.events = 8, .bytes = 1000});
  for (int i = 0; i < 5; ++i) queue.push(i, 10);
  EXPECT_EQ(queue.size(), 5u);
  EXPECT_EQ(queue.bytes(), 50u);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(queue.pop(), i);
  EXPECT_TRUE(queue.empty());
  EXPECT_EQ(queue.bytes(), 0u);
  EXPECT_EQ(queue.lost(), 0u);
}

TEST(EventQueue, LosesTheOldestWhereThereAreTooMany) {
  Queue queue({.events = 3, .bytes = 1000});
  for (int i = 0; i < 10; ++i) queue.push(i, 1);
  EXPECT_EQ(queue.lost(), 7u);
  EXPECT_EQ(queue.pop(), 7);
}

TEST(EventQueue, LosesTheOldestWhereTheyAreTooLarge) {
  Queue queue({.events = 100, .bytes = 100});
  queue.push(1, 60);
  queue.push(2, 30);
  queue.push(3, 50);
  EXPECT_EQ(queue.lost(), 1u);
  EXPECT_EQ(queue.bytes(), 80u);
  EXPECT_EQ(queue.next(), 2);
}

TEST(EventQueue, KeepsTheNewestHoweverLargeItIs) {
  Queue queue({.events = 100, .bytes = 100});
  queue.push(1, 60);
  queue.push(2, 5000);
  EXPECT_EQ(queue.size(), 1u);
  EXPECT_EQ(queue.lost(), 1u);
  EXPECT_EQ(queue.pop(), 2);
}

TEST(EventQueue, LetsGoOfWhatItLoses) {
  EventQueue<std::shared_ptr<int>> queue({.events = 1, .bytes = 100});
  const auto first = std::make_shared<int>(1);
  queue.push(first, 1);
  queue.push(std::make_shared<int>(2), 1);
  EXPECT_EQ(first.use_count(), 1);
}

TEST(EventQueue, CountsEachEventOnce) {
  std::mt19937 random(7);
  Queue queue({.events = 5, .bytes = 64});
  uint64_t pushed = 0;
  uint64_t popped = 0;
  for (int step = 0; step < 10'000; ++step) {
    if (random() % 3 != 0) {
      queue.push(step, random() % 40);
      ++pushed;
    } else if (!queue.empty()) {
      queue.pop();
      ++popped;
    }
    ASSERT_EQ(pushed, popped + queue.lost() + queue.size());
    ASSERT_TRUE(queue.size() <= 5 && (queue.bytes() <= 64 || queue.size() == 1));
  }
}

TEST(EventQueue, KeepsWhatComesWhileItIsWide) {
  Queue queue({.events = 2, .bytes = 30});
  queue.widen({.events = 6, .bytes = 1000});
  for (int i = 0; i < 5; ++i) queue.push(i, 10);
  queue.settle();
  EXPECT_EQ(queue.lost(), 0u);
  // Its usual bounds are for what comes beyond these.
  queue.push(5, 10);
  queue.push(6, 10);
  EXPECT_EQ(queue.lost(), 0u);
  queue.push(7, 10);
  EXPECT_EQ(queue.lost(), 1u);
  for (int i = 1; i <= 5; ++i) EXPECT_EQ(queue.pop(), i);
  EXPECT_EQ(queue.size(), 2u);
  for (int i = 8; i < 12; ++i) queue.push(i, 10);
  EXPECT_EQ(queue.size(), 2u) << "they are the usual ones again";
  EXPECT_EQ(queue.pop(), 10);
  EXPECT_EQ(queue.pop(), 11);
}

TEST(EventQueue, HasItsUsualBoundsWhenWhatWaitedIsGone) {
  Queue queue({.events = 1, .bytes = 30});
  queue.widen({.events = 6, .bytes = 5000});
  queue.push(0, 1000);
  queue.push(1, 10);
  queue.settle();
  queue.push(2, 1);
  queue.push(3, 1);  // The first one, of 1,000 bytes, is dropped.
  EXPECT_EQ(queue.lost(), 1u);
  queue.pop();
  queue.pop();
  queue.pop();
  queue.push(4, 1000);
  queue.push(5, 20);
  EXPECT_EQ(queue.lost(), 2u) << "no two have 1,020 bytes in 30";

  queue.widen({.events = 6, .bytes = 5000});
  queue.push(6, 2000);
  queue.settle();
  queue.erase_if([](int event) { return event == 5 || event == 6; });
  queue.push(7, 20);
  queue.push(8, 20);
  EXPECT_EQ(queue.size(), 1u);
}

TEST(EventQueue, IsBoundedWhileItIsWide) {
  Queue queue({.events = 2, .bytes = 30});
  queue.widen({.events = 3, .bytes = 0});
  for (int i = 0; i < 5; ++i) queue.push(i, 10);
  EXPECT_EQ(queue.lost(), 2u);
}

TEST(EventQueue, ForgetsWithoutCountingItAsLost) {
  EventQueue<int> queue({.events = 10, .bytes = 100});
  for (int i = 0; i < 5; ++i) queue.push(i, 10);
  queue.erase_if([](int event) { return event % 2 == 0; });
  EXPECT_EQ(queue.size(), 2u);
  EXPECT_EQ(queue.bytes(), 20u);
  EXPECT_EQ(queue.lost(), 0u);
  EXPECT_EQ(queue.pop(), 1);
  EXPECT_EQ(queue.pop(), 3);
}

}  // namespace
}  // namespace engram::memory
