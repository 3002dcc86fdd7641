// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/core/time.h"

namespace engram::ltm {

/// Returns `time` + `step`, or the closest end of the range of times if the sum overflows.
[[nodiscard]] inline Time saturated_add(Time time, Duration step) {
  int64_t sum = 0;
  if (!__builtin_add_overflow(to_ns(time), step.count(), &sum)) return time_from_ns(sum);
  return step.count() < 0 ? Time::min() : Time::max();
}

}  // namespace engram::ltm
