// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/core/mutex.h"
#include "ltm/core/time.h"

namespace engram::server {

/// Lets through so many requests per second, and as many at once as come in one second: a bucket
/// of tokens that fills steadily.
///
/// Threading: thread-safe.
class RateLimit {
 public:
  /// Needs a finite rate above 0 (checked). Of less than one request per second, one may come at
  /// once.
  RateLimit(double rate_hz, SteadyTime now);

  /// Takes one request, or refuses it, which costs nothing.
  [[nodiscard]] bool take(SteadyTime now);

 private:
  const double rate_hz_;
  const double max_tokens_;

  Mutex mutex_;
  double tokens_ ENGRAM_GUARDED_BY(mutex_);
  SteadyTime filled_ ENGRAM_GUARDED_BY(mutex_);
};

}  // namespace engram::server
