// SPDX-License-Identifier: Apache-2.0
#include "ltm/filter/frequency_filter.h"

#include <cmath>
#include <limits>
#include <random>

#include "tests/ltm/expect_status.h"

namespace engram::ltm {
namespace {

Snapshot at(double seconds) {
  return {*MemoryId::parse("a/b/c/d"),
          Time(*duration_from_seconds(1.6e9) + *duration_from_seconds(seconds)),
          {}};
}

TEST(FrequencyFilter, KeepsEverySixthFrameOfThirtyPerSecondForFive) {
  auto filter = *FrequencyFilter::create({.max_rate_hz = 5});
  for (int i = 0; i < 10'000; ++i) EXPECT_EQ(filter.keeps(at(i / 30.0)), i % 6 == 0) << i;
  EXPECT_EQ(filter.name(), "frequency");
}

TEST(FrequencyFilter, KeepsTheRateOfACameraThatJitters) {
  auto filter = *FrequencyFilter::create({.max_rate_hz = 5});
  std::mt19937 random(24);
  std::uniform_real_distribution<double> jitter(-0.05, 0.05);
  int kept = 0;
  for (int i = 0; i < 10'000; ++i) kept += filter.keeps(at((i + jitter(random)) / 30.0)) ? 1 : 0;
  EXPECT_NEAR(kept, 10'000 / 6.0, 2);
}

TEST(FrequencyFilter, KeepsEverythingThatIsSlower) {
  auto filter = *FrequencyFilter::create({.max_rate_hz = 5});
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(filter.keeps(at(i * 0.2)));
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(filter.keeps(at(100 + i * 0.7)));
}

TEST(FrequencyFilter, StartsAnewAfterAGap) {
  auto filter = *FrequencyFilter::create({.max_rate_hz = 1});
  EXPECT_TRUE(filter.keeps(at(0)));
  EXPECT_FALSE(filter.keeps(at(0.5)));
  EXPECT_TRUE(filter.keeps(at(10.3)));
  EXPECT_FALSE(filter.keeps(at(11)));
  EXPECT_TRUE(filter.keeps(at(11.3)));
}

TEST(FrequencyFilter, RefusesRatesThatAreNone) {
  for (const double rate : {0.0, -1.0, 1e-9, 1e12, std::numeric_limits<double>::quiet_NaN(),
                            std::numeric_limits<double>::infinity()})
    EXPECT_FAILS(FrequencyFilter::create({.max_rate_hz = rate}), StatusCode::kInvalidArgument,
                 "needs 1e-6 to 1e9");
  for (const double rate : {1e-6, 1e9}) EXPECT_OK(FrequencyFilter::create({.max_rate_hz = rate}));
}

}  // namespace
}  // namespace engram::ltm
