// SPDX-License-Identifier: Apache-2.0
#include "ltm/saliency/change_meter.h"

#include <cmath>
#include <numbers>
#include <random>

#include "tests/ltm/expect_status.h"
#include "tests/ltm/saliency/drawn_series.h"

namespace engram::ltm {
namespace {

/// How wrong whoever keeps all changes above `limit` is about any moment.
double max_error(const ContentSeries& series, const std::vector<double>& change, double limit) {
  double max = 0;
  size_t kept = 0;
  for (size_t i = 0; i < series.size(); ++i) {
    if (change[i] > limit) kept = i;
    max = std::max(max, distance_of(series, i, kept));
  }
  return max;
}

TEST(ChangeMeter, HoldsWhatItPromisesAtEveryLimit) {
  std::mt19937 random(7);
  std::normal_distribution<float> normal;
  std::vector<float> walk{0};
  for (int i = 1; i < 2000; ++i) walk.push_back(walk.back() + 0.02f * normal(random));
  const ContentSeries series = drawn_series(walk);
  const double pace = pace_of(series);
  EXPECT_NEAR(pace, 5 * 0.02 * std::sqrt(2 / std::numbers::pi), 0.005);  // Five steps a second.
  const auto change = measure_change(series);
  ASSERT_EQ(change.size(), walk.size());
  size_t before = walk.size() + 1;
  for (const double limit : {0.3, 1.0, 3.0, 6.0}) {
    EXPECT_LE(max_error(series, change, limit), limit * pace + 1e-9);
    const auto kept = static_cast<size_t>(
        std::ranges::count_if(change, [limit](double each) { return each > limit; }));
    EXPECT_LT(kept, before);  // A wider limit needs fewer.
    before = kept;
  }
  EXPECT_LT(before, walk.size() / 20);
}

TEST(ChangeMeter, FindsTheStepsOfASeriesThatRests) {
  std::vector<float> steps(300, 0);
  for (size_t i = 100; i < 300; ++i) steps[i] = 1;
  for (size_t i = 200; i < 300; ++i) steps[i] = 3;
  const auto change = measure_change(drawn_series(steps));
  EXPECT_TRUE(std::isinf(change[0]));
  const double pace = 3 / (299 * 0.2);  // Two steps in a minute.
  EXPECT_NEAR(change[100], 1 / pace, 1e-3);
  EXPECT_NEAR(change[200], 3 / pace, 1e-3);  // By then the first step is left out.
  for (const size_t rests : {1, 50, 99, 101, 199, 201, 299}) EXPECT_LT(change[rests], 1);
}

TEST(ChangeMeter, ATextThatChangesIsHalfAMinuteAndAPauseCountsSlowly) {
  ContentSeries series = drawn_series(std::vector<float>(50, 1));
  for (size_t i = 20; i < 50; ++i) series.facts[i] = 5;
  const auto change = measure_change(series);
  EXPECT_EQ(change[20], 30);
  EXPECT_LT(change[10], 0.2);
  // After a pause of half a day what was told before it tells little.
  for (size_t i = 30; i < 50; ++i) series.times[i] += std::chrono::hours(12);
  EXPECT_GT(measure_change(series)[30], 600);
}

TEST(ChangeMeter, AnEmptySeriesAndASingleSnapshotHaveNothingToTell) {
  EXPECT_TRUE(measure_change({}).empty());
  EXPECT_TRUE(std::isinf(measure_change(drawn_series({2}))[0]));
}

}  // namespace
}  // namespace engram::ltm
