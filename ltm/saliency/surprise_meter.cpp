// SPDX-License-Identifier: Apache-2.0
#include "ltm/saliency/surprise_meter.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "ltm/saliency/saliency.h"

namespace engram::ltm {

namespace {

/// Errors below this are none: the bound of what did not move at all. Unit: member units.
constexpr double kMinBound = 1e-3;
constexpr double kShareWithin = 0.9;

}  // namespace

double Surprise::part() const {
  if (!is_known) return 0;
  return std::max(surprise_part(ratio()), has_changed ? 1 - changed_facts : 0.0);
}

Surprise SurpriseMeter::next(const ContentSeries& series, size_t at) {
  Surprise told;
  if (seen_++ == 0 || at == 0) return told;
  const auto now = series.row(at), last = series.row(at - 1);
  const bool has_line = seen_ > 2 && at >= 2;
  const auto older = series.row(has_line ? at - 2 : at - 1);
  const double step = has_line ? to_seconds(series.times[at - 1] - series.times[at - 2]) : 0;
  const double share = step > 0 ? to_seconds(series.times[at] - series.times[at - 1]) / step : 0;

  double held_squares = 0, line_squares = 0;
  std::array<double, 2> held_max{-1, 0}, line_max{-1, 0};
  std::array<size_t, 2> at_max{0, 0};
  for (size_t i = 0; i < now.size(); ++i) {
    const double line = last[i] + share * (static_cast<double>(last[i]) - older[i]);
    const double held_off = std::abs(static_cast<double>(now[i]) - last[i]);
    const double line_off = std::abs(now[i] - line);
    held_squares += held_off * held_off;
    line_squares += line_off * line_off;
    if (held_off > held_max[0]) held_max = {held_off, last[i]}, at_max[0] = i;
    if (line_off > line_max[0]) line_max = {line_off, line}, at_max[1] = i;
  }
  const auto width = static_cast<double>(std::max<size_t>(now.size(), 1));
  const Errors errors{std::sqrt(held_squares / width), std::sqrt(line_squares / width),
                      series.facts[at] != series.facts[at - 1]};

  double held_sum = 0, line_sum = 0, changed = 0;
  for (const Errors& before : window_) {
    held_sum += before.held;
    line_sum += before.line;
    changed += before.has_changed ? 1 : 0;
  }
  told.has_changed = errors.has_changed;
  told.is_line = line_sum < held_sum;
  told.error = told.is_line ? errors.line : errors.held;
  told.member = at_max[told.is_line ? 1 : 0];
  told.predicted = told.is_line ? line_max[1] : held_max[1];
  told.is_known = window_.size() >= kMinErrors;
  if (told.is_known) {
    std::array<double, kWindow> sorted{};
    for (size_t i = 0; i < window_.size(); ++i)
      sorted[i] = told.is_line ? window_[i].line : window_[i].held;
    const auto rank =
        static_cast<ptrdiff_t>(std::ceil(kShareWithin * static_cast<double>(window_.size())) - 1);
    const auto end = sorted.begin() + static_cast<ptrdiff_t>(window_.size());
    std::nth_element(sorted.begin(), sorted.begin() + rank, end);
    told.bound = std::max(sorted[static_cast<size_t>(rank)], kMinBound);
    told.changed_facts = changed / static_cast<double>(window_.size());
  }
  window_.push_back(errors);
  if (window_.size() > kWindow) window_.pop_front();
  return told;
}

}  // namespace engram::ltm
