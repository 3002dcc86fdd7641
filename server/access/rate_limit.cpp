// SPDX-License-Identifier: Apache-2.0
#include "server/access/rate_limit.h"

#include <algorithm>
#include <cmath>

namespace engram::server {

RateLimit::RateLimit(double rate_hz, SteadyTime now)
    : rate_hz_(rate_hz), max_tokens_(std::max(1.0, rate_hz)), tokens_(max_tokens_), filled_(now) {
  ENGRAM_CHECK(std::isfinite(rate_hz) && rate_hz > 0, "rate is {} Hz", rate_hz);
}

bool RateLimit::take(SteadyTime now, double count) {
  const MutexLock lock(mutex_);
  // Threads read the clock before they take the lock, so times may arrive out of order.
  if (now > filled_) {
    tokens_ = std::min(max_tokens_, tokens_ + rate_hz_ * to_seconds(now - filled_));
    filled_ = now;
  }
  if (tokens_ < count) return false;
  tokens_ -= count;
  return true;
}

}  // namespace engram::server
