// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <functional>
#include <thread>
#include <vector>

#include "ltm/core/mutex.h"

namespace engram::server {

/// Threads that do what is handed to them, in its order. Who hands over bounds how much.
///
/// Threading: thread-safe.
class WorkQueue {
 public:
  explicit WorkQueue(int threads);
  /// Does what waits.
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
