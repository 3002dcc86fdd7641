// SPDX-License-Identifier: Apache-2.0
#include "speech/program/period.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <ctime>
#include <optional>

#include "ltm/core/printable.h"

namespace engram::speech {

namespace {

constexpr Duration kInstant{1};
constexpr std::array<std::string_view, 7> kWeekdays{"sunday",   "monday", "tuesday", "wednesday",
                                                    "thursday", "friday", "saturday"};

/// A day and a clock time as a wall shows them.
struct WallClock {
  std::tm fields{};
  Duration fraction{};
};

WallClock wall_of(Time time, DayZone zone) {
  const auto whole = std::chrono::floor<std::chrono::seconds>(time);
  const std::time_t count = whole.time_since_epoch().count();
  WallClock wall;
  wall.fraction = time - whole;
  if (zone == DayZone::kLocal)
    ::localtime_r(&count, &wall.fields);
  else
    ::gmtime_r(&count, &wall.fields);
  return wall;
}

Time time_of_wall(std::tm fields, DayZone zone) {
  fields.tm_isdst = -1;
  const std::time_t count = zone == DayZone::kLocal ? std::mktime(&fields) : ::timegm(&fields);
  // A memory has times of 1678 to 2262 alone.
  constexpr std::time_t kMaxSeconds = 9'223'000'000;
  return Time(std::chrono::seconds(std::clamp(count, -kMaxSeconds, kMaxSeconds)));
}

/// The day that begins `days` after that of a time.
Time day_begin(Time time, int days, DayZone zone) {
  std::tm fields = wall_of(time, zone).fields;
  fields.tm_hour = fields.tm_min = fields.tm_sec = 0;
  fields.tm_mday += days;
  return time_of_wall(fields, zone);
}

Period whole_day(Time time, int days, DayZone zone) {
  return {day_begin(time, days, zone), day_begin(time, days + 1, zone) - kInstant};
}

std::optional<int> whole_number(std::string_view text, int max) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < 0 || value > max)
    return {};
  return value;
}

std::optional<Period> day_of_year(std::string_view text, DayZone zone) {
  if (text.size() != 10 || text[4] != '-' || text[7] != '-') return {};
  const auto year = whole_number(text.substr(0, 4), 2261);
  const auto month = whole_number(text.substr(5, 2), 12);
  const auto day = whole_number(text.substr(8, 2), 31);
  if (!year || *year < 1678 || !month || *month < 1 || !day || *day < 1) return {};
  std::tm fields{};
  fields.tm_year = *year - 1900;
  fields.tm_mon = *month - 1;
  fields.tm_mday = *day;
  return whole_day(time_of_wall(fields, zone), 0, zone);
}

std::optional<Period> named_day(std::string_view text, Time now, DayZone zone) {
  if (text == "today") return whole_day(now, 0, zone);
  if (text == "yesterday") return whole_day(now, -1, zone);
  if (const size_t end = text.find("_days_ago"); end != std::string_view::npos)
    if (const auto days = whole_number(text.substr(0, end), 100'000);
        days && end + 9 == text.size())
      return whole_day(now, -*days, zone);
  const int today = wall_of(now, zone).fields.tm_wday;
  const auto weekday = std::find(kWeekdays.begin(), kWeekdays.end(), text);
  if (weekday != kWeekdays.end())
    return whole_day(now, -((today - static_cast<int>(weekday - kWeekdays.begin()) + 7) % 7), zone);
  if (text == "this_week" || text == "last_week") {
    const int back = (today + 6) % 7 + (text == "last_week" ? 7 : 0);
    return Period{day_begin(now, -back, zone), day_begin(now, 7 - back, zone) - kInstant};
  }
  return day_of_year(text, zone);
}

/// 08:05, 08:05:12 or 08:05:12.25 as the time since midnight, and how long it lasts.
std::optional<std::pair<Duration, Duration>> clock_time(std::string_view text) {
  const size_t colon = text.find(':');
  if (colon == std::string_view::npos || colon == 0 || colon > 2) return {};
  const auto hour = whole_number(text.substr(0, colon), 23);
  const auto minute = whole_number(text.substr(colon + 1, 2), 59);
  if (!hour || !minute || text.size() < colon + 3) return {};
  const Duration since = std::chrono::hours(*hour) + std::chrono::minutes(*minute);
  const std::string_view rest = text.substr(colon + 3);
  if (rest.empty()) return std::pair{since, std::chrono::minutes(1) - kInstant};
  if (rest.front() != ':' || rest.size() < 3) return {};
  const auto second = whole_number(rest.substr(1, 2), 59);
  if (!second) return {};
  Duration fraction{};
  if (const std::string_view digits = rest.substr(3); !digits.empty()) {
    const auto read = digits.front() == '.' ? parse_duration("0" + std::string(digits) + "s")
                                            : Result<Duration>(invalid_argument("no fraction"));
    if (!read.ok() || *read < Duration(0) || *read >= std::chrono::seconds(1)) return {};
    fraction = *read;
  }
  return std::pair{since + std::chrono::seconds(*second) + fraction, Duration(0)};
}

/// When a wall shows so long after midnight; on a day of 23 or 25 hours that is not so long later.
Time clock_of_day(Time midnight, Duration since, DayZone zone) {
  const auto minutes = std::chrono::floor<std::chrono::minutes>(since);
  std::tm fields = wall_of(midnight, zone).fields;
  fields.tm_hour = 0;
  fields.tm_min = static_cast<int>(minutes.count());
  fields.tm_sec = 0;
  return time_of_wall(fields, zone) + (since - minutes);
}

std::optional<Period> part_of_day(std::string_view text, Period day, DayZone zone) {
  const auto hours_of = [&](int from, int to) {
    return Period{clock_of_day(day.from, std::chrono::hours(from), zone),
                  clock_of_day(day.from, std::chrono::hours(to), zone) - kInstant};
  };
  if (text == "morning") return hours_of(0, 12);
  if (text == "noon") return hours_of(11, 14);
  if (text == "afternoon") return hours_of(12, 18);
  if (text == "evening") return hours_of(17, 24);
  if (text == "night") return hours_of(20, 30);
  if (const auto clock = clock_time(text)) {
    const Time from = clock_of_day(day.from, clock->first, zone);
    return Period{from, from + clock->second};
  }
  return {};
}

/// What is in the future is no time that a memory was told of, so it is a day before.
std::optional<Period> clock_before(std::string_view text, Time now, DayZone zone) {
  auto found = part_of_day(text, whole_day(now, 0, zone), zone);
  if (found && found->from > now) found = part_of_day(text, whole_day(now, -1, zone), zone);
  return found;
}

std::optional<Period> relative_to_now(std::string_view text, Time now) {
  if (text == "always") return Period{};
  if (text == "now") return Period{now, now};
  const bool is_last = text.starts_with("last:");
  if (!is_last && !text.starts_with("now-")) return {};
  const auto ago = parse_duration(text.substr(is_last ? 5 : 4));
  if (!ago.ok() || *ago < Duration(0) || now.time_since_epoch() < Duration::min() + *ago) return {};
  return Period{now - *ago, is_last ? now : now - *ago};
}

std::optional<Period> single_period(std::string_view text, Time now, DayZone zone) {
  if (const auto relative = relative_to_now(text, now)) return relative;
  if (const auto day = named_day(text, now, zone)) return day;
  if (const auto clock = clock_before(text, now, zone)) return clock;
  if (const size_t slash = text.find('/'); slash != std::string_view::npos) {
    const auto day = named_day(text.substr(0, slash), now, zone);
    return day ? part_of_day(text.substr(slash + 1), *day, zone) : std::nullopt;
  }
  const auto time = parse_time(text);
  return time.ok() ? std::optional(Period{*time, *time}) : std::nullopt;
}

std::string plural(int64_t count, const char* unit) {
  return fmt::format("{} {}{}", count, unit, count == 1 ? "" : "s");
}

}  // namespace

Result<Period> resolve_period(std::string_view text, Time now, DayZone zone) {
  const auto wrong = [&] {
    return invalid_argument(
        "'{}' is no time, needs one as yesterday, today/morning, 08:05:12, now-10s, last:10m or "
        "08:05..08:10",
        printable(text.substr(0, 60)));
  };
  const size_t dots = text.find("..");
  if (dots == std::string_view::npos) {
    const auto period = single_period(text, now, zone);
    if (!period) return wrong();
    return *period;
  }
  const auto from = single_period(text.substr(0, dots), now, zone);
  auto to = single_period(text.substr(dots + 2), now, zone);
  if (!from || !to) return wrong();
  // At 8:30, "from 8:00 to 9:00" ends today, though 9:00 alone would be yesterday's.
  if (to->to < from->from && clock_time(text.substr(dots + 2)))
    to = part_of_day(text.substr(dots + 2), whole_day(from->from, 0, zone), zone);
  if (to->to < from->from)
    return invalid_argument("'{}' ends before it begins", printable(text.substr(0, 60)));
  return Period{from->from, to->to};
}

std::string spoken_time(Time time, Time now, DayZone zone) {
  const std::tm fields = wall_of(time, zone).fields;
  const std::string clock =
      fmt::format("at {:02}:{:02}:{:02}", fields.tm_hour, fields.tm_min, fields.tm_sec);
  if (whole_day(now, 0, zone).contains(time)) return clock;
  if (whole_day(now, -1, zone).contains(time)) return "yesterday " + clock;
  return fmt::format("on {:04}-{:02}-{:02} {}", fields.tm_year + 1900, fields.tm_mon + 1,
                     fields.tm_mday, clock);
}

std::string spoken_span(Time from, Time to, Time now, DayZone zone) {
  const std::string first = spoken_time(from, now, zone);
  const std::string last = spoken_time(to, now, zone);
  // The clock stands behind the last "at ".
  const auto clock_of = [](const std::string& text) { return text.substr(text.rfind("at ") + 3); };
  if (whole_day(from, 0, zone).contains(to)) {
    const std::string day = first.substr(0, first.rfind("at "));
    return fmt::format("{}from {} to {}", day, clock_of(first), clock_of(last));
  }
  const auto without = [](std::string text) {
    for (const std::string_view word : {"at ", "on "})
      if (text.starts_with(word)) return text.substr(word.size());
    return text;
  };
  // Behind another day, a clock time alone would be of that day.
  const std::string today = last.starts_with("at ") ? "today " : "";
  return fmt::format("from {} to {}", without(first), today.empty() ? without(last) : today + last);
}

std::string spoken_duration(double length_s) {
  if (length_s < 60) {
    const double rounded = std::round(length_s * 10) / 10;
    return fmt::format("{} second{}", rounded, rounded == 1 ? "" : "s");
  }
  const auto whole = static_cast<int64_t>(std::llround(std::min(length_s, 1e15)));
  const auto two = [](int64_t large, const char* large_unit, int64_t small,
                      const char* small_unit) {
    return small == 0 ? plural(large, large_unit)
                      : plural(large, large_unit) + " and " + plural(small, small_unit);
  };
  if (whole < 3600) return two(whole / 60, "minute", whole % 60, "second");
  if (whole < 86'400) return two(whole / 3600, "hour", whole % 3600 / 60, "minute");
  return two(whole / 86'400, "day", whole % 86'400 / 3600, "hour");
}

}  // namespace engram::speech
