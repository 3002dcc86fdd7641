// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/local_time.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <ctime>

namespace engram {
namespace {

/// Central European time, without the files of the system.
class LocalTime : public ::testing::Test {
 protected:
  void SetUp() override { set("CET-1CEST,M3.5.0,M10.5.0/3"); }
  void TearDown() override { set(nullptr); }

  static void set(const char* zone) {
    if (zone != nullptr)
      ::setenv("TZ", zone, 1);
    else
      ::unsetenv("TZ");
    ::tzset();
  }

  static Time at(const char* text) { return *parse_time(text); }
};

TEST_F(LocalTime, AClockMeansTodayOrTomorrow) {
  EXPECT_EQ(*next_local_time("06:00", at("2026-01-10 03:00Z")), at("2026-01-10 05:00Z"));
  EXPECT_EQ(*next_local_time("06:00", at("2026-01-10 05:00Z")), at("2026-01-11 05:00Z"));
  EXPECT_EQ(*next_local_time("06:00:30", at("2026-01-10 05:00Z")), at("2026-01-10 05:00:30Z"));
  EXPECT_EQ(*next_local_time("00:10", at("2026-12-31 22:30Z")), at("2026-12-31 23:10Z"));
}

TEST_F(LocalTime, ANightOnWhichTheClockChangesHasItsOwnLength) {
  EXPECT_EQ(*next_local_time("06:00", at("2026-03-28 22:00Z")), at("2026-03-29 04:00Z"));
  EXPECT_EQ(*next_local_time("06:00", at("2026-10-24 22:00Z")), at("2026-10-25 05:00Z"));
}

TEST_F(LocalTime, ADateIsLocalUnlessItNamesItsZone) {
  const Time now = at("2026-06-01 12:00Z");
  EXPECT_EQ(*next_local_time("2026-07-01 06:00", now), at("2026-07-01 04:00Z"));
  EXPECT_EQ(*next_local_time("2026-12-01T06:00:05", now), at("2026-12-01 05:00:05Z"));
  EXPECT_EQ(*next_local_time("2026-07-01 06:00Z", now), at("2026-07-01 06:00Z"));
  EXPECT_EQ(*next_local_time("2026-07-01T06:00+05:00", now), at("2026-07-01 01:00Z"));
}

TEST_F(LocalTime, ErrorsTellWhatWasFoundAndNeeded) {
  const Time now = at("2026-06-01 12:00Z");
  for (const char* text :
       {"", "noon", "25:00", "06:60", "6", "06:00 tomorrow", "2026-13-01 06:00"}) {
    const auto moment = next_local_time(text, now);
    ASSERT_FALSE(moment.ok()) << text;
    EXPECT_NE(moment.status().message().find(text), std::string::npos);
    EXPECT_NE(moment.status().message().find("06:00"), std::string::npos);
  }
  const auto past = next_local_time("2026-06-01 13:59", now);
  EXPECT_EQ(past.status().message(),
            "found '2026-06-01 13:59', needs a moment after now (2026-06-01 14:00:00)");
}

TEST_F(LocalTime, PrintsWhatTheClockShows) {
  EXPECT_EQ(to_local_string(at("2026-07-01 04:00:59.9Z")), "2026-07-01 06:00:59");
}

}  // namespace
}  // namespace engram
