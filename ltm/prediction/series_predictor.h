// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ltm/prediction/member_motion.h"
#include "ltm/prediction/member_record.h"
#include "ltm/prediction/series_engine.h"
#include "ltm/prediction/value_row.h"

namespace engram::ltm {

/// What an engine was worth on an entity's own past. RMSE over all numbers, in their units.
struct SeriesRecord {
  std::string engine;
  size_t predictions = 0;  ///< That it was measured on.
  double rmse = 0;         ///< Of all of them together.
  double bound_rmse = 0;   ///< That of one is at most that, with kBoundProbability.
};

struct SeriesPrediction {
  std::vector<double> values;  ///< [numbers]
  SeriesRecord record;         ///< Of the engine that made it, at the closest number of steps.
};

/// Continues a series by the engine that was best on its own past.
///
/// For a horizon that is asked for, every engine predicts rows of the last third from what came so
/// long before; what learns, learns from all rows before each third of these. Measured again when a
/// tenth more rows have come. Nothing is done for series that nobody asks about. Threading: one
/// thread.
class SeriesPredictor {
 public:
  struct Options {
    /// Engines are measured on none before so many last rows.
    size_t last_rows = std::numeric_limits<size_t>::max();
    /// Most predictions to measure an engine and a horizon on, evenly spaced.
    size_t max_predictions = 512;
    /// Every n-th row, whatever the horizon, instead: who predicts all horizons at once does it
    /// from few rows. Down to half as many.
    bool is_anchored = false;
  };

  /// `series` outlives it; rows may be added to it.
  explicit SeriesPredictor(const NumberSeries& series)
      : SeriesPredictor(series, std::nullopt, Options{}) {}
  /// With `meaning` predictions are what its values can be, and measured as these.
  SeriesPredictor(const NumberSeries& series, std::optional<ValueRow> meaning, Options options);

  /// From the last row on, by the best engine or the one that is named. Between two steps: on the
  /// straight line from what it predicts for the one before to the one after.
  /// Errors: kNotFound where there is no row or no such engine; kInvalidArgument where `ahead` is
  /// not positive.
  Result<SeriesPrediction> predict(Duration ahead, const std::string& engine = {});

  /// What engines are worth at the number of steps that is closest, the best first. Before there is
  /// anything to measure: all with no predictions, the last value first.
  [[nodiscard]] const std::vector<SeriesRecord>& records(Duration ahead);

  /// The same of each of the values' members, in the order of make_series_engines(); without
  /// `meaning` of no member.
  [[nodiscard]] const std::vector<MemberRecords>& member_records(Duration ahead);

  /// Whether each of the members moves at a row.
  [[nodiscard]] std::vector<bool> moving_members(size_t row);

  /// From the last row on as predict() does, by the named engine alone, which is not measured.
  /// Needs a row and a name that there is (checked), and `ahead` > 0 (checked).
  [[nodiscard]] std::vector<double> continued(Duration ahead, const std::string& engine);

  /// The rows that engines are measured on: those from which so many steps
  /// later is known, and of the last third.
  [[nodiscard]] std::vector<size_t> test_rows(size_t steps) const;

 private:
  struct Measured {
    uint64_t rows = 0;                   ///< NumberSeries::added() when it was measured.
    std::vector<SeriesRecord> records;   ///< The best first.
    std::vector<MemberRecords> members;  ///< In the order of make_series_engines().
  };

  [[nodiscard]] size_t learned_rows() const;
  [[nodiscard]] bool is_fresh(uint64_t rows_then) const;
  const Measured& measured(size_t steps);
  [[nodiscard]] Measured measure(size_t steps);
  const MemberMotion& motion();
  void measure_movements(const SeriesEngine& engine, size_t steps, MemberRecords& records);
  [[nodiscard]] const std::vector<RowMember>& members() const;
  std::vector<double> predicted_row(size_t engine, size_t steps);

  const NumberSeries& series_;
  std::optional<ValueRow> meaning_;
  Options options_;
  std::vector<std::unique_ptr<SeriesEngine>> engines_;
  std::optional<MemberMotion> motion_;
  uint64_t motion_rows_ = 0;             ///< NumberSeries::added() when it was looked at.
  std::map<size_t, Measured> measured_;  ///< By steps.
  std::map<std::pair<size_t, size_t>, uint64_t> learned_;  ///< Rows then, by steps and engine.
};

}  // namespace engram::ltm
