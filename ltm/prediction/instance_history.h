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
  MeasuredError pooled;         ///< Of what counts.
  std::vector<double> squares;  ///< Mean squares; not a number where the member cannot be compared.
};

/// What is kept of the past values of one instance of an entity: numbers as rows, a sample of what
/// is larger, and the last values where a model needs them. Where the layout changes all starts
/// anew.
///
/// Threading: one thread.
class InstanceHistory {
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
  explicit InstanceHistory(const EngineChoiceInputs& inputs) : inputs_(inputs) {}

  /// `time` comes after that of the last one (checked). True where all started anew.
  bool add(Time time, const idf::Data& value);

  /// How many values like this are worth adding.
  [[nodiscard]] size_t values_wanted(const idf::Data& value) const;

  /// Whether any model is more than a copy.
  [[nodiscard]] bool has_models() const;

  // What follows needs a value (checked where that is cheap).
  [[nodiscard]] const ValueRow& rows() const { return *rows_; }
  [[nodiscard]] const MemberSamples& samples() const { return *samples_of_; }
  [[nodiscard]] const NumberSeries& series() const { return *series_; }
  [[nodiscard]] Window window() const { return window_; }
  [[nodiscard]] const idf::SplitValue& last() const { return *last_; }
  [[nodiscard]] std::span<const double> last_row() const {
    return series_->row(series_->rows() - 1);
  }

  [[nodiscard]] const std::deque<idf::Data>& values() const { return values_; }
  /// The row of the series that one of values() is of.
  [[nodiscard]] size_t row_of_value(size_t value) const {
    return series_->rows() - values_.size() + value;
  }

  /// Of the value of row `from` taken for that of row `to`: of what is no part of rows alone.
  /// Nothing where samples are not kept that far.
  [[nodiscard]] std::optional<MemberErrors> copied_error(size_t from, size_t to) const;

  /// Of a value predicted from row `from` for row `to`.
  /// Errors: kInvalidArgument where it has another layout.
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
  std::unique_ptr<NumberSeries> series_;  ///< At one place: who learns from it refers to it.
  std::optional<idf::SplitValue> last_;
  std::deque<MemberSample> samples_;  ///< Of the last rows.
  std::deque<idf::Data> values_;      ///< Of the last rows; one without a model.
};

/// Of two parts of one value, by how many elements they have; one of none is not looked at.
[[nodiscard]] double joined_error(double a, size_t a_count, double b, size_t b_count);

}  // namespace engram::ltm
