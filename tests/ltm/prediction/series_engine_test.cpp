// SPDX-License-Identifier: Apache-2.0
#include "ltm/prediction/series_engine.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

namespace engram::ltm {
namespace {

using Function = double (*)(double);

/// Two numbers, ten rows a second: f(t) and f(-t).
NumberSeries series_of(Function f, int rows) {
  NumberSeries series(2);
  for (int i = 0; i < rows; ++i) {
    const double t = 0.1 * i;
    EXPECT_TRUE(
        series.add(Time(std::chrono::milliseconds(100 * i)), std::vector{f(t), f(-t)}).ok());
  }
  return series;
}

std::vector<double> predicted(SeriesEngine& engine, const NumberSeries& series, size_t steps) {
  engine.learn(series, series.rows(), steps);
  std::vector<double> values(series.numbers());
  engine.predict(series, series.rows() - 1, steps, values);
  return values;
}

/// What every engine keeps.
class EveryEngine : public ::testing::TestWithParam<size_t> {
 protected:
  std::unique_ptr<SeriesEngine> engine = std::move(make_series_engines()[GetParam()]);
};

TEST_P(EveryEngine, StandsStillWhereNothingMoves) {
  const auto series = series_of([](double) { return 3.5; }, 60);
  for (const double value : predicted(*engine, series, 7)) EXPECT_DOUBLE_EQ(value, 3.5);
}

TEST_P(EveryEngine, PredictsFromASingleRow) {
  const auto series = series_of([](double t) { return t + 2; }, 1);
  for (const double value : predicted(*engine, series, 7)) EXPECT_DOUBLE_EQ(value, 2);
}

TEST_P(EveryEngine, LooksAtNothingBeforeAPause) {
  auto series = series_of([](double t) { return 100 * t; }, 60);
  ASSERT_TRUE(series.add(Time(std::chrono::hours(1)), std::vector{1.0, 2.0}).ok());
  EXPECT_EQ(predicted(*engine, series, 3), (std::vector{1.0, 2.0}));
}

TEST_P(EveryEngine, PredictsTheSameFromTheSamePast) {
  const auto series = series_of([](double t) { return std::sin(t) + 0.3 * std::cos(7 * t); }, 200);
  auto again = std::move(make_series_engines()[GetParam()]);
  EXPECT_EQ(predicted(*engine, series, 5), predicted(*again, series, 5));
}

TEST_P(EveryEngine, StaysFiniteWhereNumbersAreHuge) {
  for (const Function huge : {+[](double t) { return std::sin(t) * 1e150; },
                              +[](double t) { return std::sin(t) * 1e250; }})
    for (const double value : predicted(*engine, series_of(huge, 100), 50))
      EXPECT_TRUE(std::isfinite(value));
}

INSTANTIATE_TEST_SUITE_P(Series, EveryEngine, ::testing::Range<size_t>(0, 7),
                         [](const auto& engine) {
                           std::string name(make_series_engines()[engine.param]->name());
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

TEST(SeriesEngines, HaveDifferentNames) {
  std::set<std::string_view> names;
  for (const auto& engine : make_series_engines()) names.insert(engine->name());
  EXPECT_EQ(names.size(), make_series_engines().size());
  EXPECT_EQ(names.size(), 7u);
}

TEST(SeriesEngines, FollowALine) {
  const auto series = series_of([](double t) { return 2 * t + 1; }, 60);
  const double then = 2 * (5.9 + 0.7) + 1;
  for (const auto& engine : {make_line(), make_constant_velocity()})
    EXPECT_NEAR(predicted(*engine, series, 7)[0], then, 1e-9) << engine->name();
  EXPECT_NEAR(predicted(*make_autoregression(), series, 7)[0], then, 1e-3);
  EXPECT_NEAR(predicted(*make_damped_line(), series, 7)[0], 12.8 + 0.7 * 1.4, 1e-9);
}

TEST(SeriesEngines, LearnWhatTurnsBack) {
  const auto wave = [](double t) { return std::sin(2 * t); };
  const auto series = series_of(wave, 300);
  const double then = wave(29.9 + 1.0);
  const double learned = predicted(*make_autoregression(), series, 10)[0];
  const double straight = predicted(*make_line(), series, 10)[0];
  EXPECT_LT(std::abs(learned - then), 0.05);
  EXPECT_GT(std::abs(straight - then), 0.5);
}

TEST(SeriesEngines, LearnFromOtherNumbers) {
  // A joint that follows its command, among numbers that tell nothing.
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  NumberSeries series(10);
  std::vector<double> row(10);
  for (int i = 0; i < 900; ++i) {
    row[0] += 0.1 * (row[1] - row[0]);
    if (i % 25 == 0) row[1] = normal(random);
    for (size_t k = 2; k < row.size(); ++k) row[k] += normal(random);
    ASSERT_TRUE(series.add(Time(std::chrono::milliseconds(100 * i)), row).ok());
  }
  const auto error_of = [&](SeriesEngine& engine) {
    engine.learn(series, 600, 5);
    double sum = 0;
    for (size_t from = 600; from + 5 < series.rows(); ++from) {
      engine.predict(series, from, 5, row);
      sum += std::pow(row[0] - series.row(from + 5)[0], 2);
    }
    return sum;
  };
  EXPECT_LT(error_of(*make_related()), 0.8 * error_of(*make_autoregression()));
}

TEST(SeriesEngines, LearnOnlyFromRowsThatTheyAreGiven) {
  const auto series = series_of([](double t) { return t < 20 ? std::sin(2 * t) : 5 * t; }, 400);
  auto engine = make_autoregression();
  engine->learn(series, 200, 10);
  std::vector<double> early(2);
  engine->predict(series, 150, 10, early);
  EXPECT_NEAR(early[0], std::sin(2 * 16.0), 0.05);
}

}  // namespace
}  // namespace engram::ltm
