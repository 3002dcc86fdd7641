// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: how servers that are gone for a moment are waited for.

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <thread>
#include <vector>

#include "ltm/core/status.h"
#include "ltm/core/time.h"
#include "server/wire/polling_threads.h"

namespace engram::server {

inline constexpr auto kFirstWait = std::chrono::milliseconds(50);
inline constexpr auto kLongestWait = std::chrono::milliseconds(300);

/// The server is gone, stops, or is not the one that has the memory.
[[nodiscard]] inline bool is_lost(const Status& status) {
  return status.code() == StatusCode::kUnavailable || status.code() == StatusCode::kCancelled;
}

/// Waits longer each time.
///
/// Threading: one thread.
class Patience {
 public:
  explicit Patience(SteadyTime deadline) : deadline_(deadline) {}

  /// False where the deadline comes first.
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

}  // namespace engram::server
