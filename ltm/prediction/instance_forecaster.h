// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ltm/prediction/engine_choice.h"
#include "ltm/prediction/member_samples.h"
#include "ltm/prediction/series_forecaster.h"

namespace engram::ltm {

/// Continues the values of one instance of an entity, by each engine that there is.
///
/// Numbers are continued by the engines of their series, the rest of the value is copied; models
/// continue all of it. All are measured on the same moments of the last third of what is kept, see
/// Window. Where the layout of values changes all starts anew.
/// Threading: one thread.
class InstanceForecaster {
 public:
  /// What engines are measured on, by what a measurement costs.
  struct Window {
    size_t rows = 0;         ///< The last ones, of which what is needed is kept.
    size_t predictions = 0;  ///< Most of each engine and horizon, evenly spaced.
  };
  static constexpr Window kOfNumbers{4096, 512};
  static constexpr Window kOfImages{128, 128};  ///< And of large arrays.
  static constexpr Window kOfModels{512, 64};   ///< That predict numbers.
  static constexpr Window kOfImageModels{64, 16};

  /// `inputs` outlives it.
  explicit InstanceForecaster(const EngineChoiceInputs& inputs);

  /// `time` comes after that of the last one (checked).
  void add(Time time, const idf::Data& value);

  /// How many values like this are worth adding.
  [[nodiscard]] size_t values_wanted(const idf::Data& value) const;

  /// All engines, models first, then the last value.
  [[nodiscard]] std::vector<std::string> engines() const;

  /// The same, measured that far ahead; or (not empty) the one of this name, if there is one.
  Result<std::vector<EngineRecord>> records(Duration ahead, const std::string& only);

  /// By an engine of records(). Errors: those of a model.
  Result<Prediction> predict(Duration ahead, const EngineRecord& engine);

 private:
  void start(const idf::Data& value);
  [[nodiscard]] Window window_of(const ValueRow& rows) const;
  [[nodiscard]] bool has_models() const;
  [[nodiscard]] std::vector<MeasuredError> copied_errors(size_t steps) const;
  std::vector<EngineRecord> series_records(Duration ahead);
  [[nodiscard]] size_t row_of_value(size_t value) const {
    return series_->rows() - values_.size() + value;
  }
  Result<EngineRecord> model_record(const Engine& model, Duration ahead);
  Result<MeasuredError> model_error(const Engine& model, size_t row, int steps);
  Result<std::vector<Prediction>> predict_from(const Engine& model, size_t value, int steps) const;
  Result<MeasuredError> error_of(const idf::Data& predicted, size_t from, size_t to) const;

  const EngineChoiceInputs& inputs_;
  bool has_rotations_ = true;
  std::optional<ValueRow> rows_;
  std::optional<MemberSamples> members_;
  std::unique_ptr<NumberSeries> series_;  ///< At one place: the forecaster refers to it.
  std::unique_ptr<SeriesForecaster> forecaster_;
  Window window_;
  std::optional<idf::SplitValue> last_;
  std::deque<MemberSample> samples_;  ///< Of the last rows.
  std::deque<idf::Data> values_;      ///< Of the last rows; one without a model.
  /// Of predictions of a model from a row (counted with those that are gone), by steps from one on.
  std::map<std::pair<uint64_t, std::string>, std::vector<MeasuredError>> model_errors_;
};

}  // namespace engram::ltm
