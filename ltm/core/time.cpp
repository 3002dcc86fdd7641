// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/time.h"

#include <array>
#include <charconv>
#include <cmath>
#include <optional>

namespace engram {

namespace {

constexpr int64_t kNsPerSecond = 1'000'000'000;

struct TimeUnit {
  std::string_view name;
  int64_t ns;
};

// The largest unit first, so that printing finds the shortest form; aliases last.
constexpr std::array<TimeUnit, 8> kUnits{{{"d", 86400 * kNsPerSecond},
                                          {"h", 3600 * kNsPerSecond},
                                          {"min", 60 * kNsPerSecond},
                                          {"s", kNsPerSecond},
                                          {"ms", 1'000'000},
                                          {"us", 1'000},
                                          {"ns", 1},
                                          {"m", 60 * kNsPerSecond}}};

/// Consumes `min` to `max` digits from the front.
std::optional<int64_t> take_digits(std::string_view& text, size_t min, size_t max) {
  size_t count = 0;
  int64_t value = 0;
  while (count < text.size() && count < max && text[count] >= '0' && text[count] <= '9')
    value = value * 10 + (text[count++] - '0');
  if (count < min) return std::nullopt;
  text.remove_prefix(count);
  return value;
}

bool take(std::string_view& text, std::string_view expected_one_of) {
  if (text.empty() || expected_one_of.find(text.front()) == std::string_view::npos) return false;
  text.remove_prefix(1);
  return true;
}

/// Consumes the digits of a fraction, in nanoseconds; more than nine digits do not fit.
std::optional<int64_t> take_fraction_ns(std::string_view& text) {
  const size_t before = text.size();
  auto digits = take_digits(text, 1, 9);
  if (!digits) return std::nullopt;
  for (size_t i = before - text.size(); i < 9; ++i) *digits *= 10;
  return digits;
}

/// Consumes "Z", "+01:00" or nothing and returns the offset.
std::optional<std::chrono::seconds> take_zone(std::string_view& text) {
  if (text.empty() || take(text, "Zz")) return std::chrono::seconds(0);
  const bool is_behind = text.front() == '-';
  if (!take(text, "+-")) return std::nullopt;
  const auto hour = take_digits(text, 2, 2);
  if (!hour || !take(text, ":")) return std::nullopt;
  const auto minute = take_digits(text, 2, 2);
  if (!minute || *hour > 23 || *minute > 59) return std::nullopt;
  const std::chrono::seconds offset = std::chrono::hours(*hour) + std::chrono::minutes(*minute);
  return is_behind ? -offset : offset;
}

/// Returns nothing where 64 bits cannot hold the time.
std::optional<Time> time_at(std::chrono::sys_seconds whole, Duration fraction) {
  // Negative times count down from the next second, because the earliest time lies within a second
  // whose start 64 bits cannot hold.
  const bool is_early = whole.time_since_epoch().count() < 0;
  const int64_t second = whole.time_since_epoch().count() + (is_early ? 1 : 0);
  const int64_t rest = fraction.count() - (is_early ? kNsPerSecond : 0);
  int64_t ns = 0;
  if (__builtin_mul_overflow(second, kNsPerSecond, &ns) || __builtin_add_overflow(ns, rest, &ns))
    return std::nullopt;
  return time_from_ns(ns);
}

std::optional<Time> parse_calendar(std::string_view text) {
  using namespace std::chrono;
  const auto y = take_digits(text, 4, 4);
  if (!y || !take(text, "-")) return std::nullopt;
  const auto m = take_digits(text, 2, 2);
  if (!m || !take(text, "-")) return std::nullopt;
  const auto d = take_digits(text, 2, 2);
  if (!d) return std::nullopt;
  const year_month_day date{year(static_cast<int>(*y)), month(static_cast<unsigned>(*m)),
                            day(static_cast<unsigned>(*d))};
  if (!date.ok()) return std::nullopt;
  const sys_seconds day_start = sys_days(date);
  if (text.empty()) return time_at(day_start, Duration(0));
  if (!take(text, " Tt")) return std::nullopt;
  const auto hour = take_digits(text, 2, 2);
  if (!hour || !take(text, ":")) return std::nullopt;
  const auto minute = take_digits(text, 2, 2);
  if (!minute || *hour > 23 || *minute > 59) return std::nullopt;
  int64_t second = 0, fraction = 0;
  if (take(text, ":")) {
    const auto whole = take_digits(text, 2, 2);
    if (!whole || *whole > 59) return std::nullopt;
    second = *whole;
    if (take(text, ".")) {
      const auto part = take_fraction_ns(text);
      if (!part) return std::nullopt;
      fraction = *part;
    }
  }
  const auto zone = take_zone(text);
  if (!zone || !text.empty()) return std::nullopt;
  return time_at(day_start + std::chrono::hours(*hour) + std::chrono::minutes(*minute) +
                     std::chrono::seconds(second) - *zone,
                 Duration(fraction));
}

}  // namespace

Time system_now() {
  return std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
}

Result<Duration> duration_from_seconds(double value) {
  const double ns = value * 1e9;
  if (!std::isfinite(ns) || std::abs(ns) >= 9.2e18)
    return invalid_argument("{} seconds: needs a finite number of at most 292 years", value);
  return Duration(std::llround(ns));
}

std::string to_string(Time time) {
  const auto second = std::chrono::floor<std::chrono::seconds>(time);
  const auto day_point = std::chrono::floor<std::chrono::days>(second);
  const std::chrono::year_month_day date(day_point);
  const int64_t second_of_day = (second - day_point).count();
  // The remainder of a time before 1970 is negative.
  const int64_t rest = to_ns(time) % kNsPerSecond;
  const int64_t fraction = rest < 0 ? rest + kNsPerSecond : rest;
  std::string text =
      fmt::format("{:04}-{:02}-{:02} {:02}:{:02}:{:02}", static_cast<int>(date.year()),
                  static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                  second_of_day / 3600, second_of_day / 60 % 60, second_of_day % 60);
  return fraction % 1000 == 0 ? fmt::format("{}.{:06}", text, fraction / 1000)
                              : fmt::format("{}.{:09}", text, fraction);
}

Result<Time> parse_time(std::string_view text) {
  int64_t ns = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), ns);
  if (error == std::errc() && end == text.data() + text.size() && !text.empty())
    return time_from_ns(ns);
  if (const auto time = parse_calendar(text)) return *time;
  return invalid_argument(
      "'{}' is no time: needs '2022-02-18 13:06:56.492182', RFC 3339, or integer nanoseconds since "
      "1970",
      text);
}

Result<Duration> parse_duration(std::string_view text) {
  std::string_view digits = text;
  if (digits.starts_with('+')) digits.remove_prefix(1);
  double number = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  const std::string_view name(end, static_cast<size_t>(digits.data() + digits.size() - end));
  if (error == std::errc() && !digits.starts_with('+')) {
    for (const TimeUnit& unit : kUnits) {
      if (unit.name != name) continue;
      // Integers stay exact; doubles have only 53 bits.
      int64_t whole = 0;
      const auto integer = std::from_chars(digits.data(), end, whole);
      int64_t product = 0;
      if (integer.ec == std::errc() && integer.ptr == end &&
          !__builtin_mul_overflow(whole, unit.ns, &product))
        return Duration(product);
      return duration_from_seconds(number * static_cast<double>(unit.ns) / 1e9);
    }
  }
  return invalid_argument("'{}' is no duration: needs a number and one of ns us ms s min h d",
                          text);
}

std::string to_string(Duration duration) {
  const int64_t ns = duration.count();
  if (ns == 0) return "0s";
  for (const TimeUnit& unit : kUnits)
    if (ns % unit.ns == 0) return fmt::format("{}{}", ns / unit.ns, unit.name);
  return fmt::format("{}ns", ns);
}

}  // namespace engram
