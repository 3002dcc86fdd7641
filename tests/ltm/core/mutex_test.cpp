// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/mutex.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

namespace engram {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;

/// A number that several threads change.
struct Counted {
  Mutex mutex;
  ConditionVariable changed;
  StoppableCondition stoppable;
  int number ENGRAM_GUARDED_BY(mutex) = 0;
};

/// Takes the mutex in another thread, and gives it back: returns where it is free alone.
bool can_be_taken(Mutex& mutex) {
  std::jthread([&] { const MutexLock lock(mutex); }).join();
  return true;
}

TEST(Mutex, LetsOneThreadInAtATime) {
  Counted counted;
  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < 4; ++i)
      threads.emplace_back([&] {
        for (int j = 0; j < 10'000; ++j) {
          const MutexLock lock(counted.mutex);
          ++counted.number;
        }
      });
  }
  const MutexLock lock(counted.mutex);
  EXPECT_EQ(counted.number, 40'000);
}

TEST(MutexLock, IsFreeBetweenUnlockAndLock) {
  Mutex mutex;
  {
    MutexLock lock(mutex);
    lock.unlock();
    EXPECT_TRUE(can_be_taken(mutex));
    lock.lock();
  }
  EXPECT_TRUE(can_be_taken(mutex)) << "it was given back once";
  {
    MutexLock lock(mutex);
    lock.unlock();
  }
  EXPECT_TRUE(can_be_taken(mutex)) << "it was given back before the end";
}

TEST(SharedMutex, LetsReadersInTogetherAndAWriterAlone) {
  SharedMutex mutex;
  std::atomic<int> inside{0};
  std::atomic<int> max{0};
  std::atomic<bool> is_mixed{false};
  const auto wait_for_two = [&] {
    for (int i = 0; i < 2000 && max < 2; ++i) std::this_thread::sleep_for(milliseconds(1));
  };
  std::vector<std::jthread> threads;
  for (int i = 0; i < 2; ++i)
    threads.emplace_back([&] {
      const SharedLock lock(mutex);
      max = std::max<int>(max, ++inside);
      wait_for_two();
      --inside;
    });
  threads.emplace_back([&] {
    wait_for_two();
    const ExclusiveLock lock(mutex);
    is_mixed = inside != 0;
  });
  threads.clear();
  EXPECT_EQ(max, 2);
  EXPECT_FALSE(is_mixed);
}

TEST(ConditionVariable, WaitsUntilThePredicateHoldsAndKeepsTheMutex) {
  Counted counted;
  std::jthread writer([&] {
    for (int i = 0; i < 3; ++i) {
      const MutexLock lock(counted.mutex);
      ++counted.number;
      counted.changed.notify_all();
    }
  });
  const MutexLock lock(counted.mutex);
  counted.changed.wait(counted.mutex,
                       [&]() ENGRAM_REQUIRES(counted.mutex) { return counted.number == 3; });
  EXPECT_EQ(counted.number, 3);
}

TEST(ConditionVariable, TellsWhatThePredicateSaysInTheEnd) {
  Counted counted;
  const MutexLock lock(counted.mutex);
  const auto is_one = [&]() ENGRAM_REQUIRES(counted.mutex) { return counted.number == 1; };
  EXPECT_FALSE(counted.changed.wait_for(counted.mutex, milliseconds(5), is_one));
  const auto soon = std::chrono::steady_clock::now() + milliseconds(5);
  EXPECT_FALSE(counted.changed.wait_until(counted.mutex, soon, is_one));
  counted.number = 1;
  EXPECT_TRUE(counted.changed.wait_for(counted.mutex, milliseconds(5), is_one));
}

TEST(StoppableCondition, EndsWhereAStopIsRequested) {
  Counted counted;
  std::stop_source stop;
  std::jthread stopper([&] { stop.request_stop(); });
  const MutexLock lock(counted.mutex);
  const auto never = [] { return false; };
  EXPECT_FALSE(counted.stoppable.wait(counted.mutex, stop.get_token(), never));
  EXPECT_FALSE(counted.stoppable.wait_for(counted.mutex, stop.get_token(), hours(1), never));
  const auto late = std::chrono::steady_clock::now() + hours(1);
  EXPECT_FALSE(counted.stoppable.wait_until(counted.mutex, stop.get_token(), late, never));
  EXPECT_TRUE(counted.stoppable.wait(counted.mutex, stop.get_token(), [] { return true; }))
      << "what holds already is no stop";
}

}  // namespace
}  // namespace engram
