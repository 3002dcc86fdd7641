// SPDX-License-Identifier: Apache-2.0
#include "server/client/part_queue.h"

#include <utility>

#include "server/wire/polling_threads.h"

namespace engram::server {

void PartQueue::put(Result<ltm::QueryResult> part, bool is_last) {
  const BlockingScope blocking;
  const MutexLock lock(mutex_);
  changed_.wait(mutex_, [this]() ENGRAM_REQUIRES(mutex_) {
    return is_closed_ || has_last_ || parts_.size() < kMaxParts;
  });
  if (is_closed_ || has_last_) return;
  has_last_ = is_last || !part.ok();
  parts_.push_back(std::move(part));
  changed_.notify_all();
}

Result<std::optional<ltm::QueryResult>> PartQueue::take(SteadyTime deadline) {
  const BlockingScope blocking;
  const MutexLock lock(mutex_);
  const auto wait = std::max(deadline - steady_now(), SteadyTime::duration::zero());
  changed_.wait_for(mutex_, wait,
                    [this]() ENGRAM_REQUIRES(mutex_) { return has_last_ || !parts_.empty(); });
  if (parts_.empty()) {
    if (has_last_) return std::optional<ltm::QueryResult>();
    return unavailable("no part of the answer came in time");
  }
  Result<ltm::QueryResult> part = std::move(parts_.front());
  parts_.pop_front();
  changed_.notify_all();
  if (!part.ok()) return part.status();
  return std::optional(*std::move(part));
}

void PartQueue::close() {
  const MutexLock lock(mutex_);
  is_closed_ = true;
  parts_.clear();
  changed_.notify_all();
}

}  // namespace engram::server
