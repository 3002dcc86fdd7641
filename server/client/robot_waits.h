// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: how calls that concern several servers wait for them.

#include <algorithm>
#include <thread>
#include <vector>

#include "ltm/core/mutex.h"
#include "ltm/core/status.h"
#include "ltm/core/time.h"
#include "server/wire/polling_threads.h"

namespace engram::server {

/// Before what could not be reached is tried again: at first, and at most.
inline constexpr auto kFirstWait = std::chrono::milliseconds(50);
inline constexpr auto kLongestWait = std::chrono::milliseconds(300);

/// The server is gone, stops, or is not the one that has the memory.
[[nodiscard]] inline bool is_lost(const Status& status) {
  return status.code() == StatusCode::kUnavailable || status.code() == StatusCode::kCancelled;
}

/// Waits longer each time; false where `deadline` comes first.
class Backoff {
 public:
  explicit Backoff(SteadyTime deadline) : deadline_(deadline) {}

  bool wait() {
    if (steady_now() + next_ >= deadline_) return false;
    const BlockingScope blocking;
    std::this_thread::sleep_for(next_);
    next_ = std::min<Duration>(2 * next_, kLongestWait);
    return true;
  }

 private:
  SteadyTime deadline_;
  Duration next_ = kFirstWait;
};

/// Calls `work(i)` for each i below `count`, at once.
template <typename Work>
void at_once(size_t count, const Work& work) {
  const BlockingScope blocking;
  std::vector<std::jthread> threads;
  for (size_t i = 1; i < count; ++i) threads.emplace_back([&work, i] { work(i); });
  if (count > 0) work(0);
}

/// What several servers still owe.
///
/// Threading: thread-safe.
class PendingReplies {
 public:
  /// `unanswered` is what a part that nothing is said of comes to.
  PendingReplies(size_t parts, const Status& unanswered)
      : count_(parts), statuses_(parts, unanswered) {}

  void set(size_t index, const Status& status) {
    const MutexLock lock(mutex_);
    statuses_[index] = status;
    --count_;
    changed_.notify_all();
  }

  /// What all have said, or have not said until then.
  std::vector<Status> wait(SteadyTime deadline) {
    const MutexLock lock(mutex_);
    changed_.wait_until(mutex_, deadline, [this]() ENGRAM_REQUIRES(mutex_) { return count_ == 0; });
    return statuses_;
  }

 private:
  Mutex mutex_;
  ConditionVariable changed_;
  size_t count_ ENGRAM_GUARDED_BY(mutex_);
  std::vector<Status> statuses_ ENGRAM_GUARDED_BY(mutex_);
};

}  // namespace engram::server
