// SPDX-License-Identifier: Apache-2.0
#include "speech/program/period.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <optional>

#include "tests/ltm/expect_status.h"

namespace engram::speech {
namespace {

/// A Thursday.
const Time kNow = *parse_time("2026-01-08 10:20:30");

std::string period_text(std::string_view text) {
  const auto period = resolve_period(text, kNow, DayZone::kUtc);
  if (!period.ok()) return period.status().message();
  return to_string(period->from) + " " + to_string(period->to);
}

TEST(Period, OfDaysIsWhole) {
  EXPECT_EQ(period_text("today"), "2026-01-08 00:00:00.000000 2026-01-08 23:59:59.999999999");
  EXPECT_EQ(period_text("yesterday"), "2026-01-07 00:00:00.000000 2026-01-07 23:59:59.999999999");
  EXPECT_EQ(period_text("3_days_ago"), "2026-01-05 00:00:00.000000 2026-01-05 23:59:59.999999999");
  EXPECT_EQ(period_text("thursday"), period_text("today"));
  EXPECT_EQ(period_text("friday"), "2026-01-02 00:00:00.000000 2026-01-02 23:59:59.999999999");
  EXPECT_EQ(period_text("this_week"), "2026-01-05 00:00:00.000000 2026-01-11 23:59:59.999999999");
  EXPECT_EQ(period_text("last_week"), "2025-12-29 00:00:00.000000 2026-01-04 23:59:59.999999999");
  EXPECT_EQ(period_text("2026-01-02"), period_text("friday"));
  EXPECT_EQ(period_text("yesterday/morning"),
            "2026-01-07 00:00:00.000000 2026-01-07 11:59:59.999999999");
}

TEST(Period, OfClockTimesIsTheLastOneThatWas) {
  EXPECT_EQ(period_text("08:05"), "2026-01-08 08:05:00.000000 2026-01-08 08:05:59.999999999");
  EXPECT_EQ(period_text("8:05:12"), "2026-01-08 08:05:12.000000 2026-01-08 08:05:12.000000");
  EXPECT_EQ(period_text("08:05:12.5"), "2026-01-08 08:05:12.500000 2026-01-08 08:05:12.500000");
  EXPECT_EQ(period_text("22:00"), "2026-01-07 22:00:00.000000 2026-01-07 22:00:59.999999999");
  EXPECT_EQ(period_text("2026-01-02/22:00:01"),
            "2026-01-02 22:00:01.000000 2026-01-02 22:00:01.000000");
  // It is 10:20.
  EXPECT_EQ(period_text("10:00..11:00"),
            "2026-01-08 10:00:00.000000 2026-01-08 11:00:59.999999999");
  EXPECT_EQ(period_text("10:30..now-60m"), "2026-01-07 10:30:00.000000 2026-01-08 09:20:30.000000");
  EXPECT_EQ(period_text("08:05..08:10"),
            "2026-01-08 08:05:00.000000 2026-01-08 08:10:59.999999999");
}

TEST(Period, IsThatOfTheWallOnDaysOfOtherLengths) {
  const char* before = std::getenv("TZ");
  const std::optional<std::string> kept =
      before == nullptr ? std::nullopt : std::optional<std::string>(before);
  ::setenv("TZ", "CET-1CEST,M3.5.0,M10.5.0/3", 1);
  ::tzset();
  // On this day 2:00 is followed by 3:00, so it is 7:00 in UTC when a wall shows 9:00.
  const Time now = *parse_time("2026-03-29 20:00:00");
  const auto nine = resolve_period("today/09:00", now, DayZone::kLocal);
  const auto afternoon = resolve_period("today/afternoon", now, DayZone::kLocal);
  if (kept)
    ::setenv("TZ", kept->c_str(), 1);
  else
    ::unsetenv("TZ");
  ::tzset();
  ASSERT_OK(nine);
  EXPECT_EQ(to_string(nine->from), "2026-03-29 07:00:00.000000");
  ASSERT_OK(afternoon);
  EXPECT_EQ(to_string(afternoon->from), "2026-03-29 10:00:00.000000");
}

TEST(Period, CountsFromNow) {
  EXPECT_EQ(period_text("now"), "2026-01-08 10:20:30.000000 2026-01-08 10:20:30.000000");
  EXPECT_EQ(period_text("now-10s"), "2026-01-08 10:20:20.000000 2026-01-08 10:20:20.000000");
  EXPECT_EQ(period_text("last:10m"), "2026-01-08 10:10:30.000000 2026-01-08 10:20:30.000000");
  EXPECT_EQ(period_text("2026-01-07T10:00:00Z"),
            "2026-01-07 10:00:00.000000 2026-01-07 10:00:00.000000");
}

TEST(Period, IsNoneOfWhatIsNoTime) {
  for (const char* text : {"", "soon", "25:00", "8:60", "now-", "now--5s", "last:", "2026-13-01",
                           "-1_days_ago", "yesterday/late", "8:05:1", "8:05:12.x"}) {
    SCOPED_TRACE(text);
    EXPECT_FAILS(resolve_period(text, kNow, DayZone::kUtc), StatusCode::kInvalidArgument,
                 "is no time");
  }
}

TEST(Period, IsSpokenByTheDay) {
  const auto spoken = [](const char* text) {
    return spoken_time(*parse_time(text), kNow, DayZone::kUtc);
  };
  EXPECT_EQ(spoken("2026-01-08 08:05:12"), "at 08:05:12");
  EXPECT_EQ(spoken("2026-01-07 08:05:12"), "yesterday at 08:05:12");
  EXPECT_EQ(spoken("2026-01-01 08:05:12"), "on 2026-01-01 at 08:05:12");
  const auto span = [](const char* from, const char* to) {
    return spoken_span(*parse_time(from), *parse_time(to), kNow, DayZone::kUtc);
  };
  EXPECT_EQ(span("2026-01-08 08:05:12", "2026-01-08 09:00"), "from 08:05:12 to 09:00:00");
  EXPECT_EQ(span("2026-01-01 08:05:12", "2026-01-08 09:00"),
            "from 2026-01-01 at 08:05:12 to today at 09:00:00");
  EXPECT_EQ(span("2026-01-07 08:05:12", "2026-01-07 09:00"), "yesterday from 08:05:12 to 09:00:00");
  EXPECT_EQ(span("2026-01-01 08:05:12", "2026-01-01 09:00"),
            "on 2026-01-01 from 08:05:12 to 09:00:00");
  EXPECT_EQ(span("2026-01-01 08:05:12", "2026-01-07 09:00"),
            "from 2026-01-01 at 08:05:12 to yesterday at 09:00:00");
  EXPECT_EQ(spoken_duration(3.249), "3.2 seconds");
  EXPECT_EQ(spoken_duration(1), "1 second");
  EXPECT_EQ(spoken_duration(125), "2 minutes and 5 seconds");
  EXPECT_EQ(spoken_duration(3600), "1 hour");
}

}  // namespace
}  // namespace engram::speech
