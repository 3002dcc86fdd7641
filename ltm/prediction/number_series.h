// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "ltm/core/time.h"

namespace engram::ltm {

/// What the numbers of one entity were, newest last: what predictions of them start and learn from.
///
/// Rows belong to one run as long as no interval is much longer than usual: nothing is learned
/// across a pause.
/// Threading: one thread.
class NumberSeries {
 public:
  /// Keeps the last `max_rows` rows at least, twice as many at most.
  /// Needs two rows (checked); without numbers it is a series of moments.
  explicit NumberSeries(size_t numbers, size_t max_rows = 4096);

  /// Shape: row [numbers()].
  /// Errors: kInvalidArgument where the row has another number of numbers, one of them is not
  /// finite, or its time does not come after the last.
  Status add(Time time, std::span<const double> row);

  [[nodiscard]] size_t numbers() const { return numbers_; }
  [[nodiscard]] size_t rows() const { return times_.size(); }
  /// Those that are not kept any more included.
  [[nodiscard]] uint64_t added() const { return added_; }

  [[nodiscard]] Time time(size_t row) const { return times_[row]; }
  [[nodiscard]] std::span<const double> row(size_t row) const {
    return {values_.data() + row * numbers_, numbers_};
  }

  /// First row of the run that `row` is of.
  [[nodiscard]] size_t run_start(size_t row) const { return run_starts_[row]; }

  /// The usual interval: the median of the last ones. Zero where there is none.
  [[nodiscard]] Duration step() const { return step_; }

  /// Steps that come closest to a duration, at least one.
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
