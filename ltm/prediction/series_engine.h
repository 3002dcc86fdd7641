// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "ltm/prediction/number_series.h"

namespace engram::ltm {

/// An engine that predicts a series of numbers.
///
/// Threading: one thread.
/// Source: docs/prediction.md, section "Numbers".
class SeriesEngine {
 public:
  virtual ~SeriesEngine() = default;

  /// The engine's name in answers.
  [[nodiscard]] virtual std::string_view name() const = 0;

  /// True if learn() changes its predictions.
  [[nodiscard]] virtual bool learns() const { return false; }

  /// Learns from the rows before `end` to predict `steps` steps ahead, if it learns at all.
  virtual void learn(const NumberSeries& /*series*/, size_t /*end*/, size_t /*steps*/) {}

  /// Predicts the numbers `steps` steps after `row`, from that row and the ones before it.
  /// Shape: predicted [series.numbers()].
  virtual void predict(const NumberSeries& series, size_t row, size_t steps,
                       std::span<double> predicted) const = 0;
};

/// Predicts the last value.
[[nodiscard]] std::unique_ptr<SeriesEngine> make_copy_last();
/// Continues a straight line through the last five values, fitted by least squares.
[[nodiscard]] std::unique_ptr<SeriesEngine> make_line();
/// Continues from the last value with 0.7 of that line's slope.
[[nodiscard]] std::unique_ptr<SeriesEngine> make_damped_line();
/// Continues from the last value with the change between the last two.
[[nodiscard]] std::unique_ptr<SeriesEngine> make_constant_velocity();
/// Continues a parabola through the last three values: things that are carried start, turn and
/// stop.
[[nodiscard]] std::unique_ptr<SeriesEngine> make_quadratic();
/// Adds a weighted sum of the last seven changes to the last value. The weights of each number and
/// horizon are learned by ridge regression. Without enough rows to learn from, it predicts the last
/// value.
[[nodiscard]] std::unique_ptr<SeriesEngine> make_autoregression();

/// Adds a weighted sum of the last seven changes and of up to nine further features to the last
/// value. The features are the levels and changes, of this and other numbers, that explain most of
/// what follows, as long as they reduce the error on held-out windows. With more than 96 numbers or
/// without enough rows to learn from, it predicts the last value.
[[nodiscard]] std::unique_ptr<SeriesEngine> make_related();

/// Makes one engine of each kind, copy-last first.
[[nodiscard]] std::vector<std::unique_ptr<SeriesEngine>> make_series_engines();

}  // namespace engram::ltm
