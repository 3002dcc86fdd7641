// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "server/prediction/series_engine.h"

namespace engram::server {

/// What an engine was worth on an entity's own past. RMSE over all numbers, in their units.
struct EngineRecord {
  std::string engine;
  size_t predictions = 0;  ///< That it was measured on.
  double rmse = 0;         ///< Of all of them together.
  double bound_rmse = 0;   ///< That of one is at most that, with ltm::kBoundProbability.
};

struct SeriesPrediction {
  std::vector<double> values;  ///< [numbers]
  EngineRecord record;         ///< Of the engine that made it.
  Duration horizon{};          ///< Steps that come closest to what was asked for.
};

/// Continues a series by the engine that was best on its own past.
///
/// For a horizon that is asked for, every engine predicts up to 512 rows of the last third from
/// what came before; what learns, learns from the first two thirds. Measured again when a tenth
/// more rows have come. Nothing is done for series that nobody asks about. Threading: one thread.
class SeriesForecaster {
 public:
  /// `series` outlives it; rows may be added to it.
  explicit SeriesForecaster(const NumberSeries& series);

  /// From the last row on, by the best engine or the one that is named.
  /// Errors: kNotFound where there is no row or no such engine; kInvalidArgument where `ahead` is
  /// not positive.
  Result<SeriesPrediction> predict(Duration ahead, const std::string& engine = {});

  /// What engines are worth so far ahead, the best first. Before there is anything to measure: all
  /// with no predictions, the last value first.
  [[nodiscard]] const std::vector<EngineRecord>& records(Duration ahead);

 private:
  struct Measured {
    uint64_t rows = 0;  ///< NumberSeries::added() when it was measured.
    std::vector<EngineRecord> records;
  };

  const Measured& measured(size_t steps);
  [[nodiscard]] std::vector<EngineRecord> measure(size_t steps) const;

  const NumberSeries& series_;
  std::vector<std::unique_ptr<SeriesEngine>> engines_;
  std::map<size_t, Measured> measured_;  ///< By steps.
};

}  // namespace engram::server
