// SPDX-License-Identifier: Apache-2.0
#include "server/prediction/series_forecaster.h"

#include <algorithm>
#include <cmath>

namespace engram::server {

namespace {

constexpr size_t kMostWindows = 512;
/// As ltm::kBoundProbability says.
constexpr double kBoundShare = 0.9;
/// Measured again when so many more rows have come, relative to those that there were.
constexpr double kMoreRows = 0.1;

/// Rows of the last third from which `steps` later is known and of the same run.
std::vector<size_t> test_rows(const NumberSeries& series, size_t first, size_t steps) {
  std::vector<size_t> rows;
  for (size_t row = first; row + steps < series.rows(); ++row)
    if (series.run_start(row + steps) <= row) rows.push_back(row);
  if (rows.size() <= kMostWindows) return rows;
  std::vector<size_t> some;
  for (size_t i = 0; i < kMostWindows; ++i) some.push_back(rows[i * rows.size() / kMostWindows]);
  return some;
}

double mean_square(std::span<const double> a, std::span<const double> b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum / static_cast<double>(a.size());
}

/// Of an engine whose predictions were that wrong.
EngineRecord record_of(std::string_view engine, std::vector<double> mean_squares) {
  EngineRecord record{std::string(engine), mean_squares.size()};
  if (mean_squares.empty()) return record;
  double sum = 0;
  for (const double one : mean_squares) sum += one;
  record.rmse = std::sqrt(sum / static_cast<double>(mean_squares.size()));
  std::ranges::sort(mean_squares);
  const double rank = std::ceil(kBoundShare * static_cast<double>(mean_squares.size() + 1)) - 1;
  const auto last = static_cast<double>(mean_squares.size() - 1);
  record.bound_rmse = std::sqrt(mean_squares[static_cast<size_t>(std::min(rank, last))]);
  return record;
}

}  // namespace

SeriesForecaster::SeriesForecaster(const NumberSeries& series)
    : series_(series), engines_(make_series_engines()) {}

std::vector<EngineRecord> SeriesForecaster::measure(size_t steps) const {
  const size_t split = series_.rows() * 2 / 3;
  const std::vector<size_t> rows = test_rows(series_, split, steps);
  std::vector<EngineRecord> records;
  std::vector<double> predicted(series_.numbers());
  for (const auto& engine : make_series_engines()) {
    engine->learn(series_, split, steps);
    std::vector<double> mean_squares;
    for (const size_t row : rows) {
      engine->predict(series_, row, steps, predicted);
      mean_squares.push_back(mean_square(predicted, series_.row(row + steps)));
    }
    records.push_back(record_of(engine->name(), std::move(mean_squares)));
  }
  std::ranges::stable_sort(records, {}, &EngineRecord::rmse);
  return records;
}

const SeriesForecaster::Measured& SeriesForecaster::measured(size_t steps) {
  Measured& known = measured_[steps];
  const auto enough = static_cast<uint64_t>(std::ceil(static_cast<double>(known.rows) * kMoreRows));
  if (!known.records.empty() && series_.added() < known.rows + std::max<uint64_t>(enough, 1))
    return known;
  known = {series_.added(), measure(steps)};
  for (const auto& engine : engines_) engine->learn(series_, series_.rows(), steps);
  return known;
}

const std::vector<EngineRecord>& SeriesForecaster::records(Duration ahead) {
  return measured(series_.steps_in(ahead)).records;
}

Result<SeriesPrediction> SeriesForecaster::predict(Duration ahead, const std::string& engine) {
  if (series_.rows() == 0) return not_found("series: found no row, needs one to predict from");
  if (ahead <= Duration(0))
    return invalid_argument("series: found a horizon of {}, needs more than zero",
                            to_string(ahead));
  const size_t steps = series_.steps_in(ahead);
  const std::vector<EngineRecord>& records = measured(steps).records;
  const auto record =
      engine.empty() ? records.begin() : std::ranges::find(records, engine, &EngineRecord::engine);
  if (record == records.end()) {
    std::string names;
    for (const auto& known : engines_)
      names += (names.empty() ? "" : ", ") + std::string(known->name());
    return not_found("series: nothing named '{}' predicts it; there is: {}", engine, names);
  }
  SeriesPrediction prediction{std::vector<double>(series_.numbers()), *record,
                              series_.step() * static_cast<int64_t>(steps)};
  const auto used =
      std::ranges::find(engines_, record->engine, [](const auto& one) { return one->name(); });
  (*used)->predict(series_, series_.rows() - 1, steps, prediction.values);
  return prediction;
}

}  // namespace engram::server
