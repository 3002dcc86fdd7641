// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "ltm/core/status.h"

namespace engram {

using Duration = std::chrono::nanoseconds;

/// A moment. Unit: nanoseconds since the Unix epoch, UTC. Range: years 1678 to 2262.
using Time = std::chrono::sys_time<Duration>;

/// Returns the current time. It is passed as an argument so that tests control time.
using Clock = std::function<Time()>;

/// The clock of the operating system.
[[nodiscard]] Time system_now();

/// A moment of a clock that is never set, for leases and rates. It has no meaning on other
/// machines.
using SteadyTime = std::chrono::steady_clock::time_point;
using SteadyClock = std::function<SteadyTime()>;

[[nodiscard]] inline SteadyTime steady_now() { return std::chrono::steady_clock::now(); }

[[nodiscard]] inline int64_t to_ns(Time time) { return time.time_since_epoch().count(); }
[[nodiscard]] inline Time time_from_ns(int64_t ns) { return Time(Duration(ns)); }

[[nodiscard]] inline double to_seconds(Duration duration) {
  return std::chrono::duration<double>(duration).count();
}

/// Rounded to the nearest nanosecond.
/// Errors: kInvalidArgument if not finite or beyond what 64 bits hold.
Result<Duration> duration_from_seconds(double seconds);

/// Prints "2022-02-18 13:06:56.492182": UTC with six digits, or nine where the time needs them.
[[nodiscard]] std::string to_string(Time time);

/// Reads the printed form, RFC 3339 ("2022-02-18T13:06:56.49Z", "...+01:00"), or an integer of
/// nanoseconds since the epoch.
/// Errors: kInvalidArgument naming the text and what was needed.
Result<Time> parse_time(std::string_view text);

/// Reads "200ms", "-1.5s", "2h", "250us", "3d": a number and one of ns us ms s min m h d.
/// Errors: kInvalidArgument naming the text and what was needed.
Result<Duration> parse_duration(std::string_view text);

/// The shortest exact form that parse_duration reads: "200ms", "1500ms", "0s".
[[nodiscard]] std::string to_string(Duration duration);

}  // namespace engram
