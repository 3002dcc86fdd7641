// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ltm/prediction/member_motion.h"
#include "ltm/prediction/member_record.h"
#include "ltm/prediction/series_engine.h"
#include "ltm/prediction/value_row.h"

namespace engram::ltm {

/// The measured errors of an engine on an entity's own past. RMSE over all numbers, in their units.
struct SeriesRecord {
  std::string engine;
  size_t predictions = 0;  ///< Number of measured predictions.
  double rmse = 0;         ///< Over all predictions together.
  double bound_rmse = 0;   ///< One prediction stays within it, with kBoundProbability.
};

struct SeriesPrediction {
  std::vector<double> values;  ///< [numbers]
  SeriesRecord record;         ///< Of the engine that predicted, at the closest number of steps.
};

/// Predicts a series with the engine that was best on its own past.
///
/// For each requested horizon, every engine predicts rows of the last third of the series from the
/// rows that long before them. That third is split into three blocks, and engines that learn do so
/// from all rows before each block. Engines are measured again after a tenth more rows. A series
/// that nobody asks about costs nothing.
/// Threading: one thread.
class SeriesPredictor {
 public:
  struct Options {
    /// Engines are measured only on this many last rows.
    size_t last_rows = std::numeric_limits<size_t>::max();
    /// Max predictions per engine and horizon, evenly spaced.
    size_t max_predictions = 512;
    /// If true, predictions start from every n-th row, the same ones for all horizons. A model that
    /// predicts all horizons at once then runs from few rows. It may halve the number of
    /// predictions.
    bool is_anchored = false;
  };

  /// `series` must outlive it; rows may be added to it.
  explicit SeriesPredictor(const NumberSeries& series)
      : SeriesPredictor(series, std::nullopt, Options{}) {}
  /// With `meaning` predictions are made valid for its values (ValueRow::finish), and errors are
  /// measured on its members.
  SeriesPredictor(const NumberSeries& series, std::optional<ValueRow> meaning, Options options);

  /// Predicts from the last row on, with the best engine or the named one. Between two steps it
  /// interpolates linearly between their predictions.
  /// Errors: kNotFound if there is no row or no such engine; kInvalidArgument if `ahead` is not
  /// positive.
  Result<SeriesPrediction> predict(Duration ahead, const std::string& engine = {});

  /// The errors of all engines at the closest number of steps, the best engine first. If nothing
  /// can be measured yet, all have 0 predictions and copy-last comes first.
  [[nodiscard]] std::vector<SeriesRecord> records(Duration ahead);

  /// The same errors per member of the values, of the engines with these names, or of all, in the
  /// order of make_series_engines(). The others are not measured. Without `meaning` there are no
  /// members.
  [[nodiscard]] std::vector<MemberRecords> member_records(
      Duration ahead, std::span<const std::string_view> names = {});

  /// For each member, whether it moves at a row.
  [[nodiscard]] std::vector<bool> moving_members(size_t row);

  /// Predicts from the last row on as predict() does, with the named engine and without measuring.
  /// Needs a row, a known name and `ahead` > 0 (all checked).
  [[nodiscard]] std::vector<double> continued(Duration ahead, const std::string& engine);

  /// The rows that measured predictions start from: those whose row `steps` steps later is known
  /// and in the last third.
  [[nodiscard]] std::vector<size_t> test_rows(size_t steps) const;

 private:
  struct MeasuredEngine {
    SeriesRecord record;
    MemberRecords members;
  };
  struct Measured {
    uint64_t rows = 0;  ///< NumberSeries::added() at the measurement.
    std::map<std::string, MeasuredEngine, std::less<>> engines;
  };

  [[nodiscard]] size_t learned_rows() const;
  [[nodiscard]] bool is_fresh(uint64_t rows_then) const;
  [[nodiscard]] std::vector<MeasuredEngine> measured(Duration ahead,
                                                     std::span<const std::string_view> names);
  [[nodiscard]] MeasuredEngine measure(SeriesEngine& engine, size_t steps);
  const MemberMotion& motion();
  void measure_movements(const SeriesEngine& engine, size_t steps, MemberRecords& records);
  [[nodiscard]] const std::vector<RowMember>& members() const;
  std::vector<double> predicted_row(size_t engine, size_t steps);

  const NumberSeries& series_;
  std::optional<ValueRow> meaning_;
  Options options_;
  std::vector<std::unique_ptr<SeriesEngine>> engines_;
  std::optional<MemberMotion> motion_;
  uint64_t motion_rows_ = 0;             ///< NumberSeries::added() when motion_ was made.
  std::map<size_t, Measured> measured_;  ///< The key is the number of steps.
  /// NumberSeries::added() when an engine last learned. The key is the number of steps and the
  /// engine.
  std::map<std::pair<size_t, size_t>, uint64_t> learned_;
};

}  // namespace engram::ltm
