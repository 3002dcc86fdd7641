// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <stop_token>
#include <thread>
#include <vector>

#include "ltm/core/mutex.h"

namespace engram::ltm {

/// Threads that share the work of one caller. There is one job at a time, so there is no queue.
///
/// Threading: one thread calls run(); the work runs on it and on the threads of the pool.
class WorkerPool {
 public:
  /// `threads` includes the caller's: with 1 the pool starts no thread.
  explicit WorkerPool(int threads);

  /// Calls `work` with 0 to `count` - 1, each once, in any order, and returns when all are done.
  /// `work` must not throw.
  void run(size_t count, const std::function<void(size_t)>& work);

 private:
  void serve(const std::stop_token& stop);
  void take_one() ENGRAM_REQUIRES(mutex_);

  Mutex mutex_;
  StoppableCondition more_;
  ConditionVariable done_;
  const std::function<void(size_t)>* work_ ENGRAM_GUARDED_BY(mutex_) = nullptr;
  size_t count_ ENGRAM_GUARDED_BY(mutex_) = 0;
  size_t next_ ENGRAM_GUARDED_BY(mutex_) = 0;
  size_t finished_ ENGRAM_GUARDED_BY(mutex_) = 0;

  std::vector<std::jthread> threads_;  ///< The last member, so that they end before what they use.
};

}  // namespace engram::ltm
