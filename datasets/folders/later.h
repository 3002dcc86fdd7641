// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include "ltm/core/status.h"
#include "ltm/core/time.h"

namespace engram::datasets {

/// Returns `time` + `more`.
/// Errors: kInvalidArgument if the result is after the year 2262.
inline Result<Time> later(Time time, Duration more) {
  int64_t ns = 0;
  if (!__builtin_add_overflow(to_ns(time), more.count(), &ns)) return time_from_ns(ns);
  return invalid_argument("{} behind {} is behind the year 2262", to_string(more), to_string(time));
}

}  // namespace engram::datasets
