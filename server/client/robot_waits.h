// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: how calls that concern several servers wait and retry.

#include <algorithm>
#include <thread>
#include <vector>

#include "ltm/core/mutex.h"
#include "ltm/core/status.h"
#include "ltm/core/time.h"
#include "server/wire/polling_threads.h"

namespace engram::server {

/// The first and the max wait before an unreachable server is tried again.
inline constexpr auto kFirstWait = std::chrono::milliseconds(50);
inline constexpr auto kLongestWait = std::chrono::milliseconds(300);

/// Whether a status means that the server is gone or stops.
[[nodiscard]] inline bool is_lost(const Status& status) {
  return status.code() == StatusCode::kUnavailable || status.code() == StatusCode::kCancelled;
}

/// Waits before retries, twice as long each time up to kLongestWait.
class Backoff {
 public:
  explicit Backoff(SteadyTime deadline) : deadline_(deadline) {}

  /// Sleeps before the next try. Returns false without sleeping if `deadline` would come first.
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

/// Calls `work(i)` for each i below `count`, each on a thread of its own, and waits for all.
template <typename Work>
void at_once(size_t count, const Work& work) {
  const BlockingScope blocking;
  std::vector<std::jthread> threads;
  for (size_t i = 1; i < count; ++i) threads.emplace_back([&work, i] { work(i); });
  if (count > 0) work(0);
}

/// Collects the replies of several servers, and lets a caller wait for them.
///
/// Threading: thread-safe.
class PendingReplies {
 public:
  /// `unanswered` is the status of a part that has no reply by the deadline.
  PendingReplies(size_t parts, const Status& unanswered)
      : count_(parts), statuses_(parts, unanswered) {}

  void set(size_t index, const Status& status) {
    const MutexLock lock(mutex_);
    statuses_[index] = status;
    --count_;
    changed_.notify_all();
  }

  /// Waits until all parts have a reply or the deadline has passed, and returns their statuses.
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
