// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

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

  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<std::function<void()>> waiting_;
  bool is_ending_ = false;
  std::vector<std::jthread> threads_;
};

}  // namespace engram::server
