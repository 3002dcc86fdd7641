// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <functional>
#include <thread>
#include <vector>

#include "ltm/core/mutex.h"

namespace engram::server {

/// Threads that run functions in the order in which they were added. The queue is unbounded:
/// callers limit how much they add.
///
/// Threading: thread-safe.
class WorkQueue {
 public:
  explicit WorkQueue(int threads);
  /// Runs all waiting functions, then ends.
  ~WorkQueue();

  void add(std::function<void()> work);

 private:
  void run();

  Mutex mutex_;
  ConditionVariable wake_;
  std::deque<std::function<void()>> waiting_ ENGRAM_GUARDED_BY(mutex_);
  bool is_ending_ ENGRAM_GUARDED_BY(mutex_) = false;
  std::vector<std::jthread> threads_;
};

}  // namespace engram::server
