// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/local_time.h"

#include <ctime>
#include <optional>

namespace engram {

namespace {

std::tm local_calendar(Time time) {
  const std::time_t seconds =
      std::chrono::floor<std::chrono::seconds>(time).time_since_epoch().count();
  std::tm calendar{};
  localtime_r(&seconds, &calendar);
  return calendar;
}

/// The moment that a calendar of local time shows; days beyond the end of the month count on.
std::optional<Time> moment_of(std::tm calendar) {
  calendar.tm_isdst = -1;
  const std::time_t seconds = std::mktime(&calendar);
  if (seconds == -1) return std::nullopt;
  return Time(std::chrono::seconds(seconds));
}

/// Reads a time of day as seconds since midnight.
std::optional<std::chrono::seconds> parse_clock(std::string_view text) {
  // parse_time needs a date, which has no effect.
  const auto moment = parse_time("2000-01-01 " + std::string(text) + "Z");
  if (!moment.ok()) return std::nullopt;
  const auto since = *moment - std::chrono::floor<std::chrono::days>(*moment);
  return std::chrono::floor<std::chrono::seconds>(since);
}

std::optional<Time> next_of_clock(std::chrono::seconds clock, Time now) {
  for (const int days : {0, 1}) {
    std::tm calendar = local_calendar(now);
    calendar.tm_mday += days;
    // Sets hours and minutes, not seconds since midnight: on a day when the clock changes these
    // differ.
    const auto seconds = static_cast<int>(clock.count());
    calendar.tm_hour = seconds / 3600;
    calendar.tm_min = seconds / 60 % 60;
    calendar.tm_sec = seconds % 60;
    const auto moment = moment_of(calendar);
    if (moment && *moment > now) return moment;
  }
  return std::nullopt;
}

/// The moment of a date and a time of day in local time.
std::optional<Time> moment_of_date(std::string_view text) {
  const auto moment = parse_time(std::string(text) + "Z");
  if (!moment.ok()) return std::nullopt;
  const std::time_t seconds =
      std::chrono::floor<std::chrono::seconds>(*moment).time_since_epoch().count();
  std::tm calendar{};
  gmtime_r(&seconds, &calendar);
  return moment_of(calendar);
}

}  // namespace

Result<Time> next_local_time(std::string_view text, Time now) {
  if (const auto clock = parse_clock(text)) {
    if (const auto moment = next_of_clock(*clock, now)) return *moment;
  }
  auto moment = moment_of_date(text);
  if (!moment) {
    const auto with_zone = parse_time(text);
    if (!with_zone.ok() || text.find(':') == std::string_view::npos)
      return invalid_argument(
          "found '{}', needs a local time like 06:00 or a date with one, like 2026-03-01 06:00",
          text);
    moment = *with_zone;
  }
  if (*moment <= now)
    return invalid_argument("found '{}', needs a moment after now ({})", text,
                            to_local_string(now));
  return *moment;
}

std::string to_local_string(Time time) {
  const std::tm calendar = local_calendar(time);
  return fmt::format("{:04}-{:02}-{:02} {:02}:{:02}:{:02}", calendar.tm_year + 1900,
                     calendar.tm_mon + 1, calendar.tm_mday, calendar.tm_hour, calendar.tm_min,
                     calendar.tm_sec);
}

}  // namespace engram
