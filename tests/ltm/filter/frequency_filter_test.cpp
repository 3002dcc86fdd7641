// SPDX-License-Identifier: Apache-2.0
#include "ltm/filter/frequency_filter.h"

#include <cmath>
#include <limits>
#include <random>

#include "tests/ltm/filter/candidates.h"

namespace engram::ltm {
namespace {

TEST(FrequencyFilter, KeepsEverySixthFrameOfThirtyPerSecondForFive) {
  auto filter = *FrequencyFilter::create({.max_rate_hz = 5});
  FilterRun run(filter);
  for (int i = 0; i < 10'000; ++i) EXPECT_EQ(run.keeps(candidate(i / 30.0)), i % 6 == 0) << i;
  EXPECT_EQ(run.dropped("rate"), 10'000 - run.kept().size());
  EXPECT_EQ(filter.name(), "frequency");
}

TEST(FrequencyFilter, KeepsTheRateOfACameraThatJitters) {
  auto filter = *FrequencyFilter::create({.max_rate_hz = 5});
  FilterRun run(filter);
  std::mt19937 random(24);
  std::uniform_real_distribution<double> jitter(-0.05, 0.05);
  for (int i = 0; i < 10'000; ++i) run.offer(candidate((i + jitter(random)) / 30.0));
  EXPECT_NEAR(static_cast<double>(run.kept().size()), 10'000 / 6.0, 2);
}

TEST(FrequencyFilter, TellsFromTheTimeAloneWhatItDrops) {
  auto filter = *FrequencyFilter::create({.max_rate_hz = 5});
  FilterRun run(filter);
  std::mt19937 random(25);
  std::exponential_distribution<double> gap(20);
  double second = 0;
  for (int i = 0; i < 1'000; ++i) {
    const auto reason = filter.drops_at(at_second(second));
    EXPECT_EQ(run.keeps(candidate(second)), !reason) << second;
    EXPECT_EQ(reason.value_or("rate"), "rate");
    second += gap(random);
  }
}

TEST(FrequencyFilter, KeepsEverythingThatIsSlower) {
  auto filter = *FrequencyFilter::create({.max_rate_hz = 5});
  FilterRun run(filter);
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(run.keeps(candidate(i * 0.2)));
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(run.keeps(candidate(100 + i * 0.7)));
}

TEST(FrequencyFilter, StartsAnewAfterAGap) {
  auto filter = *FrequencyFilter::create({.max_rate_hz = 1});
  FilterRun run(filter);
  for (const double second : {0.0, 0.5, 10.3, 11.0, 11.3}) run.offer(candidate(second));
  EXPECT_EQ(run.kept(), (std::vector<double>{0, 10.3, 11.3}));
}

TEST(FrequencyFilter, TakesTimesAtTheEndOfTheirRange) {
  auto filter = *FrequencyFilter::create({.max_rate_hz = 1e-6});
  EXPECT_TRUE(filter.is_due(Time::min()));
  EXPECT_FALSE(filter.is_due(Time::min() + Duration(1)));
  EXPECT_TRUE(filter.is_due(Time::max() - Duration(1)));
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
