// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/core/mutex.h"
#include "ltm/core/time.h"

namespace engram::server {

/// Limits the rate of requests by a token bucket that fills steadily and holds the requests of one
/// second.
///
/// Threading: thread-safe.
class RateLimit {
 public:
  /// Needs a finite rate above 0 (checked). Below one request per second, a single request may
  /// still come at once.
  RateLimit(double rate_hz, SteadyTime now);

  /// Accepts a request, or `count` of them at once, or refuses them; refused requests cost nothing.
  [[nodiscard]] bool take(SteadyTime now, double count = 1);

 private:
  const double rate_hz_;
  const double max_tokens_;

  Mutex mutex_;
  double tokens_ ENGRAM_GUARDED_BY(mutex_);
  SteadyTime filled_ ENGRAM_GUARDED_BY(mutex_);
};

}  // namespace engram::server
