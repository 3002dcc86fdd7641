// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "ltm/prediction/engine_choice.h"
#include "ltm/prediction/member_samples.h"
#include "ltm/prediction/number_series.h"

// Private to this room.

namespace engram::ltm {

/// The error of a prediction as a whole and of each member of the layout, in its order.
struct MemberErrors {
  MeasuredError pooled;         ///< Over the members that count.
  std::vector<double> squares;  ///< Mean squares; NaN if the member cannot be compared.
};

/// Keeps the past values of one instance of an entity: numbers as rows, samples of images and large
/// arrays, and the last whole values if a model needs them. If the layout changes, it starts again
/// from empty.
///
/// Threading: one thread.
class InstanceHistory {
 public:
  /// The rows that engines are measured on. It is smaller if a measurement costs more.
  struct Window {
    size_t rows = 0;         ///< Number of last rows whose samples and values are kept.
    size_t predictions = 0;  ///< Max predictions per engine and horizon, evenly spaced.
  };
  static constexpr Window kOfNumbers{4096, 512};
  static constexpr Window kOfImages{128, 128};  ///< For images and large arrays.
  static constexpr Window kOfModels{512, 64};   ///< For models that predict numbers.
  static constexpr Window kOfImageModels{64, 16};

  /// `inputs` must outlive it.
  explicit InstanceHistory(const EngineChoiceInputs& inputs) : inputs_(inputs) {}

  /// Adds a value; `time` must be after that of the last one (checked). Returns true if the layout
  /// changed, so that the history started again.
  bool add(Time time, const idf::Data& value);

  /// The number of values like this one that are used. Adding more is of no use.
  [[nodiscard]] size_t values_wanted(const idf::Data& value) const;

  /// True if there is a model other than a copy.
  [[nodiscard]] bool has_models() const;

  // The functions below need at least one value (checked if that is cheap).
  [[nodiscard]] const ValueRow& rows() const { return *rows_; }
  [[nodiscard]] const MemberSamples& samples() const { return *samples_of_; }
  [[nodiscard]] const NumberSeries& series() const { return *series_; }
  [[nodiscard]] Window window() const { return window_; }
  [[nodiscard]] const idf::SplitValue& last() const { return *last_; }
  [[nodiscard]] std::span<const double> last_row() const {
    return series_->row(series_->rows() - 1);
  }

  [[nodiscard]] const std::deque<idf::Data>& values() const { return values_; }
  /// The row of the series that belongs to an index into values().
  [[nodiscard]] size_t row_of_value(size_t value) const {
    return series_->rows() - values_.size() + value;
  }

  /// The error of taking the value of row `from` for that of row `to`, only over the members that
  /// are not part of rows. Nothing if samples are not kept that far back.
  [[nodiscard]] std::optional<MemberErrors> copied_error(size_t from, size_t to) const;

  /// The error of a value predicted from row `from` for row `to`.
  /// Errors: kInvalidArgument if it has another layout.
  [[nodiscard]] Result<MemberErrors> error_of(const idf::Data& predicted, size_t from,
                                              size_t to) const;

 private:
  void start(const idf::Data& value);
  [[nodiscard]] Window window_of(const ValueRow& rows) const;
  [[nodiscard]] MemberErrors members_of(const MemberSample& recorded,
                                        const MemberSample& other) const;

  const EngineChoiceInputs& inputs_;
  bool has_rotations_ = true;
  Window window_;
  std::optional<ValueRow> rows_;
  std::optional<MemberSamples> samples_of_;
  std::unique_ptr<NumberSeries> series_;  ///< A pointer, as predictors hold references to it.
  std::optional<idf::SplitValue> last_;
  std::deque<MemberSample> samples_;  ///< Of the last rows.
  std::deque<idf::Data> values_;      ///< Of the last rows; only one value without a model.
};

/// The mean error of two parts of one value, weighted by their numbers of elements. A part without
/// elements is ignored.
[[nodiscard]] double joined_error(double a, size_t a_count, double b, size_t b_count);

}  // namespace engram::ltm
