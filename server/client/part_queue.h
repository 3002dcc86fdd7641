// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <deque>
#include <optional>

#include "ltm/core/mutex.h"
#include "ltm/core/time.h"
#include "ltm/memory/result.h"

namespace engram::server {

/// The parts of an answer on their way from the thread of a stream to the one that asked. The
/// stream waits while nobody takes them, so few are in memory, and the server makes no more.
///
/// Threading: thread-safe.
class PartQueue {
 public:
  /// Adds a part, or why there is none; waits for room. Parts after the last one are ignored.
  void put(Result<ltm::QueryResult> part, bool is_last);

  /// The next part; nothing after the last one.
  /// Errors: those that were put; kUnavailable at `deadline`.
  Result<std::optional<ltm::QueryResult>> take(SteadyTime deadline);

  /// Nobody takes parts any more.
  void close();

 private:
  static constexpr size_t kMaxParts = 4;

  Mutex mutex_;
  ConditionVariable changed_;
  std::deque<Result<ltm::QueryResult>> parts_ ENGRAM_GUARDED_BY(mutex_);
  bool has_last_ ENGRAM_GUARDED_BY(mutex_) = false;
  bool is_closed_ ENGRAM_GUARDED_BY(mutex_) = false;
};

}  // namespace engram::server
