// SPDX-License-Identifier: Apache-2.0
#include "ltm/prediction/number_series.h"

#include <algorithm>
#include <cmath>

#include "ltm/core/check.h"

namespace engram::ltm {

namespace {

/// Number of last intervals whose median is the usual one.
constexpr size_t kIntervals = 32;
/// A run ends if the next row comes later than this many usual intervals.
constexpr double kPause = 2.5;

}  // namespace

NumberSeries::NumberSeries(size_t numbers, size_t max_rows)
    : numbers_(numbers), max_rows_(max_rows) {
  ENGRAM_CHECK(max_rows > 1, "{} rows", max_rows);
}

Status NumberSeries::add(Time time, std::span<const double> row) {
  if (row.size() != numbers_)
    return invalid_argument("series: found {} numbers, needs {}", row.size(), numbers_);
  if (!std::ranges::all_of(row, [](double x) { return std::isfinite(x); }))
    return invalid_argument("series: found a number that is not finite at {}", to_string(time));
  if (!times_.empty() && time <= times_.back())
    return invalid_argument("series: found {}, needs a moment after {}", to_string(time),
                            to_string(times_.back()));
  if (rows() == 2 * max_rows_) forget_oldest(max_rows_);
  const bool is_new_run =
      times_.empty() ||
      (step_ > Duration(0) && to_seconds(time - times_.back()) > kPause * to_seconds(step_));
  run_starts_.push_back(is_new_run ? rows() : run_starts_.back());
  times_.push_back(time);
  values_.insert(values_.end(), row.begin(), row.end());
  ++added_;
  if (!is_new_run) update_step();
  return {};
}

void NumberSeries::forget_oldest(size_t count) {
  const auto rows_gone = static_cast<std::ptrdiff_t>(count);
  times_.erase(times_.begin(), times_.begin() + rows_gone);
  run_starts_.erase(run_starts_.begin(), run_starts_.begin() + rows_gone);
  values_.erase(values_.begin(),
                values_.begin() + rows_gone * static_cast<std::ptrdiff_t>(numbers_));
  for (size_t& start : run_starts_) start -= std::min(start, count);
}

void NumberSeries::update_step() {
  std::vector<Duration> intervals;
  for (size_t row = rows() - 1; row > run_starts_.back() && intervals.size() < kIntervals; --row)
    intervals.push_back(times_[row] - times_[row - 1]);
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::ranges::nth_element(intervals, middle);
  step_ = *middle;
}

size_t NumberSeries::steps_in(Duration duration) const {
  if (step_ <= Duration(0)) return 1;
  return static_cast<size_t>(std::max(1.0, std::round(to_seconds(duration) / to_seconds(step_))));
}

}  // namespace engram::ltm
