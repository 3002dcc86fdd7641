// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: waits for replies, and tries again.

#include <algorithm>
#include <atomic>
#include <future>
#include <memory>
#include <thread>
#include <type_traits>

#include "ltm/core/status.h"
#include "ltm/core/time.h"
#include "server/wire/polling_threads.h"

namespace engram::server {

inline constexpr auto kFirstRetry = std::chrono::milliseconds(20);
inline constexpr auto kMaxRetry = std::chrono::milliseconds(500);

/// Calls `call`, and repeats it until `deadline` while it returns kUnavailable.
template <typename Call>
auto retried(SteadyTime deadline, const Call& call) -> decltype(call()) {
  for (Duration wait = kFirstRetry;; wait = std::min<Duration>(2 * wait, kMaxRetry)) {
    auto result = call();
    const StatusCode code = [&] {
      if constexpr (std::is_same_v<decltype(call()), Status>)
        return result.code();
      else
        return result.status().code();
    }();
    if (code != StatusCode::kUnavailable || steady_now() + wait >= deadline) return result;
    std::this_thread::sleep_for(wait);
  }
}

/// The value that a blocked caller waits for. It is shared with handlers, which may run after the
/// caller has timed out.
template <typename Value>
struct Awaited {
  std::promise<Value> promise;
  std::atomic<bool> is_set{false};

  void set(Value value) {
    if (!is_set.exchange(true)) promise.set_value(std::move(value));
  }
};

/// Waits for the value until `deadline`, then it is what `late` says.
template <typename Value, typename Late>
Value wait_for(const std::shared_ptr<Awaited<Value>>& awaited, SteadyTime deadline,
               const Late& late) {
  auto future = awaited->promise.get_future();
  // A commit that was not sent is done already: nobody is to be woken for it.
  if (awaited->is_set) return future.get();
  const BlockingScope blocking;
  if (future.wait_until(deadline) == std::future_status::ready) return future.get();
  awaited->set(late());
  return future.get();
}

}  // namespace engram::server
