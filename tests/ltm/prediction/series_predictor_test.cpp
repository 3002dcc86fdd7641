// SPDX-License-Identifier: Apache-2.0
#include "ltm/prediction/series_predictor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace engram::ltm {
namespace {

using std::chrono::milliseconds;

/// Adds rows of one number, ten a second.
template <typename Function>
void add(NumberSeries& series, int rows, Function f) {
  for (int i = 0; i < rows; ++i) {
    const auto row = static_cast<int64_t>(series.added());
    ASSERT_TRUE(
        series.add(Time(milliseconds(100 * row)), std::vector{f(0.1 * static_cast<double>(row))})
            .ok());
  }
}

double wave(double t) {
  return std::sin(2 * t);
}

TEST(SeriesPredictor, AnswersWithTheEngineThatWasBest) {
  NumberSeries series(1);
  add(series, 300, wave);
  SeriesPredictor predictor(series);
  const auto answer = predictor.predict(milliseconds(1000));
  ASSERT_TRUE(answer.ok()) << answer.status().to_string();
  EXPECT_EQ(answer->record.engine, "autoregression");
  EXPECT_NEAR(answer->values[0], wave(30.9), 0.05);
  EXPECT_GT(answer->record.predictions, 80u);
  const auto& records = predictor.records(milliseconds(1000));
  ASSERT_EQ(records.size(), make_series_engines().size());
  EXPECT_TRUE(std::ranges::is_sorted(records, {}, &SeriesRecord::rmse));
}

TEST(SeriesPredictor, ANamedEngineHasTheErrorsThatItHasAmongAll) {
  NumberSeries series(1);
  add(series, 300, wave);
  SeriesPredictor named(series), all(series);
  ASSERT_TRUE(named.predict(milliseconds(500), "line").ok());
  // A few rows do not make old measurements stale, but engines are compared on the same rows.
  add(series, 5, wave);
  for (const SeriesRecord& expected : all.records(milliseconds(500))) {
    const auto answer = named.predict(milliseconds(500), expected.engine);
    ASSERT_TRUE(answer.ok()) << answer.status().to_string();
    if (expected.engine == "line") continue;  // It may still have the errors of earlier rows.
    EXPECT_EQ(answer->record.rmse, expected.rmse) << expected.engine;
    EXPECT_EQ(answer->record.bound_rmse, expected.bound_rmse) << expected.engine;
  }
  const auto records = named.records(milliseconds(500));
  const auto expected = all.records(milliseconds(500));
  ASSERT_EQ(records.size(), expected.size());
  for (size_t i = 0; i < records.size(); ++i) {
    EXPECT_EQ(records[i].engine, expected[i].engine);
    EXPECT_EQ(records[i].rmse, expected[i].rmse);
  }
}

TEST(SeriesPredictor, ChoosesPerHorizon) {
  // A random walk: nothing beats the last value far ahead.
  NumberSeries series(1);
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  double value = 0;
  add(series, 3000, [&](double) { return value += normal(random); });
  SeriesPredictor predictor(series);
  for (const int ahead : {100, 3000}) {
    const auto& records = predictor.records(milliseconds(ahead));
    const auto last = std::ranges::find(records, "copy-last", &SeriesRecord::engine);
    EXPECT_GE(records.front().rmse, 0.95 * last->rmse) << ahead;
    EXPECT_GT(records.back().rmse, 1.2 * last->rmse) << ahead;
  }
}

TEST(SeriesPredictor, TellsABoundThatMostPredictionsKeep) {
  NumberSeries series(1);
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal;
  double value = 0;
  const auto walk = [&](double) { return value += normal(random); };
  add(series, 2000, walk);
  SeriesPredictor predictor(series);
  int kept = 0;
  constexpr int kCount = 1000;
  for (int i = 0; i < kCount; ++i) {
    const auto answer = predictor.predict(milliseconds(100));
    ASSERT_TRUE(answer.ok());
    add(series, 1, walk);
    const double error = std::abs(series.row(series.rows() - 1)[0] - answer->values[0]);
    kept += error <= answer->record.bound_rmse ? 1 : 0;
  }
  EXPECT_NEAR(kept, 0.9 * kCount, 0.04 * kCount);
}

TEST(SeriesPredictor, MeasuresAgainWhereThePastChanges) {
  NumberSeries series(1);
  add(series, 300, [](double) { return 1.0; });
  SeriesPredictor predictor(series);
  EXPECT_EQ(predictor.predict(milliseconds(1000))->record.engine, "copy-last");
  add(series, 1500, wave);
  EXPECT_EQ(predictor.predict(milliseconds(1000))->record.engine, "autoregression");
}

TEST(SeriesPredictor, AnswersFromLittle) {
  NumberSeries series(1);
  SeriesPredictor predictor(series);
  EXPECT_EQ(predictor.predict(milliseconds(100)).status().code(), StatusCode::kNotFound);
  add(series, 1, wave);
  const auto answer = predictor.predict(milliseconds(100));
  ASSERT_TRUE(answer.ok());
  EXPECT_EQ(answer->record.engine, "copy-last");
  EXPECT_EQ(answer->record.predictions, 0u);
  EXPECT_FALSE(predictor.predict(Duration(0)).ok());
}

TEST(SeriesPredictor, TakesTheEngineThatIsNamed) {
  NumberSeries series(1);
  add(series, 50, wave);
  SeriesPredictor predictor(series);
  EXPECT_EQ(predictor.predict(milliseconds(100), "line")->record.engine, "line");
  const auto unknown = predictor.predict(milliseconds(100), "oracle");
  EXPECT_EQ(unknown.status().code(), StatusCode::kNotFound);
  EXPECT_NE(unknown.status().message().find("damped-line"), std::string::npos);
}

}  // namespace
}  // namespace engram::ltm
