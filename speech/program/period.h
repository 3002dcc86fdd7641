// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "ltm/core/time.h"

namespace engram::speech {

/// By which clock days and clock times are meant.
enum class DayZone {
  kUtc,    ///< As everything that Engram prints.
  kLocal,  ///< That of the environment (TZ).
};

/// A time from a moment to a moment, both included. Equal ends are a moment.
struct Period {
  Time from = Time::min();
  Time to = Time::max();

  [[nodiscard]] bool is_moment() const { return from == to; }
  [[nodiscard]] bool contains(Time time) const { return from <= time && time <= to; }
  friend bool operator==(Period, Period) = default;
};

/// Reads a time in words of programs, relative to `now`:
///
///     always                        today            yesterday       3_days_ago      monday
///     2026-01-02                    today/morning    this_week       last_week
///     08:05 (that minute)           08:05:12         yesterday/08:05 2026-01-02/08:05:12.5
///     now                           now-10s          last:10m        08:05..08:10
///
/// and what parse_time() reads. A clock time without a day is the last one up to `now`; morning
/// ends at noon, afternoon at 18:00, and night goes from 20:00 to 6:00. Errors: kInvalidArgument
/// naming the text and what was needed. Threading: with kLocal it must not run while the
/// environment's TZ changes.
Result<Period> resolve_period(std::string_view text, Time now, DayZone zone);

/// "yesterday at 08:05:12", "at 08:05:12", "on 2026-01-02 at 08:05:12": as people would say it on
/// the day of `now`.
[[nodiscard]] std::string spoken_time(Time time, Time now, DayZone zone);

/// "from 08:05:12 to 08:05:20", "from yesterday at 08:05:12 to 08:05:20".
[[nodiscard]] std::string spoken_span(Time from, Time to, Time now, DayZone zone);

/// "2 minutes and 5 seconds", "3.2 seconds".
[[nodiscard]] std::string spoken_duration(double seconds);

}  // namespace engram::speech
