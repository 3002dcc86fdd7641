// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <functional>
#include <thread>

#include "ltm/core/mutex.h"
#include "ltm/core/time.h"

namespace engram::navigation {

/// Does work on a thread of its own, so that whoever waits for it can act when it takes long.
///
/// Owns: the thread.
/// Threading: one thread.
class WorkAside {
 public:
  WorkAside();

  /// Returns when `work` is done. If that takes longer than `soon`, `when_late` is called once
  /// meanwhile, by the thread that waits.
  /// Complexity: about 0.05 ms more than the work.
  void run(const std::function<void()>& work, Duration soon,
           const std::function<void()>& when_late);

 private:
  void work_on(const std::stop_token& stop);

  Mutex mutex_;
  StoppableCondition has_work_;
  ConditionVariable is_done_;
  const std::function<void()>* work_ ENGRAM_GUARDED_BY(mutex_) = nullptr;  ///< Null: all is done.
  std::jthread thread_;
};

}  // namespace engram::navigation
