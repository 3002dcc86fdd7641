// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "ltm/core/time.h"

namespace engram::ltm {

/// The past numbers of one entity, oldest first. Series engines learn from them and predict from
/// them.
///
/// Rows belong to one run until an interval is much longer than usual. Nothing is learned across
/// such a pause.
/// Threading: one thread.
class NumberSeries {
 public:
  /// Keeps at least the last `max_rows` rows and at most twice as many. `max_rows` must be at least
  /// two (checked). With 0 numbers it is a series of moments.
  explicit NumberSeries(size_t numbers, size_t max_rows = 4096);

  /// Adds a row. Shape: row [numbers()].
  /// Errors: kInvalidArgument if the row has another number of numbers, one of them is not finite,
  /// or its time is not after the last one.
  Status add(Time time, std::span<const double> row);

  [[nodiscard]] size_t numbers() const { return numbers_; }
  [[nodiscard]] size_t rows() const { return times_.size(); }
  /// Number of rows that were ever added, including those that are no longer kept.
  [[nodiscard]] uint64_t added() const { return added_; }

  [[nodiscard]] Time time(size_t row) const { return times_[row]; }
  [[nodiscard]] std::span<const double> row(size_t row) const {
    return {values_.data() + row * numbers_, numbers_};
  }

  /// First row of the run that `row` belongs to.
  [[nodiscard]] size_t run_start(size_t row) const { return run_starts_[row]; }

  /// The usual interval: the median of the last intervals. Zero if there is none.
  [[nodiscard]] Duration step() const { return step_; }

  /// The number of steps that is closest to a duration, at least one.
  [[nodiscard]] size_t steps_in(Duration duration) const;

 private:
  void forget_oldest(size_t count);
  void update_step();

  size_t numbers_;
  size_t max_rows_;
  uint64_t added_ = 0;
  std::vector<Time> times_;
  std::vector<double> values_;  ///< [rows, numbers]
  std::vector<size_t> run_starts_;
  Duration step_{};
};

}  // namespace engram::ltm
