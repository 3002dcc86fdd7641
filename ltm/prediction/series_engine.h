// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "ltm/prediction/number_series.h"

namespace engram::ltm {

/// A way to continue a series of numbers.
///
/// Threading: one thread.
/// Source: docs/prediction.md, section "Numbers".
class SeriesEngine {
 public:
  virtual ~SeriesEngine() = default;

  /// What an answer names as its engine.
  [[nodiscard]] virtual std::string_view name() const = 0;

  /// Whether it says something else after learn().
  [[nodiscard]] virtual bool learns() const { return false; }

  /// Learns from the rows before `end` what comes so many steps later, if it learns at all.
  virtual void learn(const NumberSeries& /*series*/, size_t /*end*/, size_t /*steps*/) {}

  /// The numbers so many steps after `row`, from that row and the ones before it.
  /// Shape: predicted [series.numbers()].
  virtual void predict(const NumberSeries& series, size_t row, size_t steps,
                       std::span<double> predicted) const = 0;
};

/// The last value.
[[nodiscard]] std::unique_ptr<SeriesEngine> make_copy_last();
/// A straight line through the last five values, by least squares.
[[nodiscard]] std::unique_ptr<SeriesEngine> make_line();
/// The last value, moved on by 0.7 of that line's slope.
[[nodiscard]] std::unique_ptr<SeriesEngine> make_damped_line();
/// The last value, moved on as it was between the last two.
[[nodiscard]] std::unique_ptr<SeriesEngine> make_constant_velocity();
/// A parabola through the last three values: things that are carried start, turn and stop.
[[nodiscard]] std::unique_ptr<SeriesEngine> make_quadratic();
/// The last value and a weighted sum of the last seven changes; weights of each number and each
/// horizon by ridge regression. Without enough to learn from: the last value.
[[nodiscard]] std::unique_ptr<SeriesEngine> make_autoregression();

/// The last value and a weighted sum of the last seven changes and of up to nine further features:
/// levels and changes of this and other numbers that tell most of what comes, as far as they do so
/// on held-out windows. With more than 96 numbers or without enough to learn from: the last value.
[[nodiscard]] std::unique_ptr<SeriesEngine> make_related();

/// One of each, the last value first.
[[nodiscard]] std::vector<std::unique_ptr<SeriesEngine>> make_series_engines();

}  // namespace engram::ltm
