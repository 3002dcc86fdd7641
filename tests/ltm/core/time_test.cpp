// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/time.h"

#include <limits>

#include "tests/ltm/expect_status.h"
#include "tests/ltm/random_values.h"

namespace engram {
namespace {

TEST(Time, PrintsAsManyDigitsAsItCarries) {
  EXPECT_EQ(to_string(time_from_ns(0)), "1970-01-01 00:00:00.000000");
  EXPECT_EQ(to_string(time_from_ns(1)), "1970-01-01 00:00:00.000000001");
  EXPECT_EQ(to_string(time_from_ns(-1)), "1969-12-31 23:59:59.999999999");
  EXPECT_EQ(to_string(time_from_ns(1645189616492182000)), "2022-02-18 13:06:56.492182");
}

TEST(Time, ReadsEveryForm) {
  const int64_t noon = 1645185600'000'000'000;
  const std::pair<const char*, int64_t> cases[] = {
      {"2022-02-18 12:00:00", noon},
      {"2022-02-18T12:00:00Z", noon},
      {"2022-02-18t12:00:00z", noon},
      {"2022-02-18 12:00", noon},
      {"2022-02-18T12:00:00.5Z", noon + 500'000'000},
      {"2022-02-18T12:00:00.123456789Z", noon + 123'456'789},
      {"2022-02-18T13:00:00+01:00", noon},
      {"2022-02-18T06:30:00-05:30", noon},
      {"2022-02-18", noon - 12 * 3600'000'000'000},
      {"2020-02-29", 1582934400'000'000'000},
      {"1645185600000000000", noon},
      {"-5", -5},
      {"0", 0}};
  for (const auto& [text, ns] : cases) {
    const auto time = parse_time(text);
    ASSERT_OK(time);
    EXPECT_EQ(to_ns(*time), ns) << text;
  }
}

TEST(Time, RefusesWhatIsNone) {
  for (const char* text : {"",
                           " ",
                           "yesterday",
                           "2022-02",
                           "2022-13-01",
                           "2022-02-30",
                           "2021-02-29",
                           "2022-02-18 ",
                           "2022-02-18 24:00:00",
                           "2022-02-18 12:60:00",
                           "2022-02-18 12:00:60",
                           "2022-02-18 12:00:00.",
                           "2022-02-18 12:00:00.1234567891",
                           "2022-02-18 12:00:00 x",
                           "2022-02-18T12:00:00+1:00",
                           "2022-02-18T12:00:00+24:00",
                           "2022-02-18T12:00:00+01",
                           "1.5",
                           "9223372036854775808",
                           "+5",
                           "5s",
                           "1600-01-01",
                           "2262-04-12",
                           "9999-12-31",
                           "1677-09-21 00:12:43.145224191"}) {
    SCOPED_TRACE(text);
    EXPECT_FAILS(parse_time(text), StatusCode::kInvalidArgument, "is no time");
  }
}

TEST(Time, ReadsBackWhatItPrints) {
  RandomValues random(19);
  for (int i = 0; i < 20'000; ++i) {
    const Time time = time_from_ns(static_cast<int64_t>(random.bits()));
    const auto read = parse_time(to_string(time));
    ASSERT_OK(read);
    EXPECT_EQ(*read, time);
  }
}

TEST(Time, ReadsBackTheLimits) {
  for (const int64_t ns :
       {std::numeric_limits<int64_t>::min(), std::numeric_limits<int64_t>::max()})
    EXPECT_EQ(to_ns(*parse_time(to_string(time_from_ns(ns)))), ns);
  EXPECT_EQ(to_string(Time::max()), "2262-04-11 23:47:16.854775807");
  EXPECT_EQ(to_string(Time::min()), "1677-09-21 00:12:43.145224192");
}

TEST(Duration, ReadsNumbersWithUnits) {
  using namespace std::chrono_literals;
  const std::pair<const char*, Duration> cases[] = {{"200ms", 200ms},
                                                    {"-1.5s", -1500ms},
                                                    {"2h", 2h},
                                                    {"250us", 250us},
                                                    {"3d", 72h},
                                                    {"5min", 5min},
                                                    {"5m", 5min},
                                                    {"7ns", 7ns},
                                                    {"+1s", 1s},
                                                    {"0s", 0s},
                                                    {"1e3ms", 1s},
                                                    {"0.1s", 100ms},
                                                    {"9223372036854775807ns", Duration::max()},
                                                    {"-9223372036854775808ns", Duration::min()}};
  for (const auto& [text, expected] : cases) {
    const auto duration = parse_duration(text);
    ASSERT_OK(duration);
    EXPECT_EQ(*duration, expected) << text;
  }
}

TEST(Duration, RefusesWhatIsNone) {
  for (const char* text : {"", "5", "s", "5 s", "5sec", "five s", "++5s", "5s ", "infs", "nans",
                           "1e30s", "300y", "9223372036854775808ns", "1000000d"}) {
    SCOPED_TRACE(text);
    EXPECT_FAILS(parse_duration(text), StatusCode::kInvalidArgument, "");
  }
}

TEST(Duration, ReadsBackWhatItPrints) {
  EXPECT_EQ(to_string(std::chrono::milliseconds(1500)), "1500ms");
  EXPECT_EQ(to_string(Duration(0)), "0s");
  EXPECT_EQ(to_string(std::chrono::hours(48)), "2d");
  RandomValues random(20);
  for (int i = 0; i < 5000; ++i) {
    const Duration duration(static_cast<int64_t>(random.bits()) >> random.below(60));
    EXPECT_EQ(*parse_duration(to_string(duration)), duration);
  }
}

TEST(Duration, ComesFromSeconds) {
  EXPECT_EQ(*duration_from_seconds(0.2), std::chrono::milliseconds(200));
  EXPECT_EQ(*duration_from_seconds(-1e-9), Duration(-1));
  for (const double seconds : {1e300, -1e11, std::numeric_limits<double>::infinity(),
                               std::numeric_limits<double>::quiet_NaN()})
    EXPECT_FAILS(duration_from_seconds(seconds), StatusCode::kInvalidArgument, "292 years");
  EXPECT_EQ(to_seconds(std::chrono::milliseconds(1500)), 1.5);
}

}  // namespace
}  // namespace engram
