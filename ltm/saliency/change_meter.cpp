// SPDX-License-Identifier: Apache-2.0
#include "ltm/saliency/change_meter.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

namespace engram::ltm {

namespace {

/// What another text counts as, and how much of a pause counts as a second of change.
constexpr double kFactsSeconds = 30;
constexpr double kPausePerSecond = 60;
/// An entity that rests most of the time changes at least so fast. Unit: member units per second.
constexpr double kMinPace = 0.02;
/// A longer step is a pause, in which nothing is known to change. Unit: median steps.
constexpr double kLongestStep = 10;
constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// Leaves out snapshots. Each that stays has a span: itself and those left out behind it, with the
/// bounds of all their numbers.
class BottomUp {
 public:
  explicit BottomUp(const ContentSeries& series)
      : series_(series),
        low_(series.numbers),
        high_(series.numbers),
        before_(series.size()),
        after_(series.size()),
        last_(series.size()),
        version_(series.size(), 0),
        is_mixed_(series.size(), false),
        pace_(pace_of(series)) {
    for (size_t i = 0; i < series.size(); ++i) {
      before_[i] = i == 0 ? 0 : i - 1;
      after_[i] = i + 1;
      last_[i] = i;
      if (i > 0) queue_.push({cost(i), i, 0});
    }
  }

  std::vector<double> run() {
    std::vector<double> change(series_.size(), kInfinite);
    double reached = 0;
    while (!queue_.empty()) {
      const Step step = queue_.top();
      queue_.pop();
      if (step.version != version_[step.at]) continue;
      reached = std::max(reached, step.cost);
      change[step.at] = reached;
      leave_out(step.at);
    }
    return change;
  }

 private:
  struct Step {
    double cost = 0;
    size_t at = 0;
    uint32_t version = 0;

    /// Of equal ones the later goes first.
    friend bool operator<(const Step& a, const Step& b) {
      return a.cost != b.cost ? a.cost > b.cost : a.at < b.at;
    }
  };

  /// How wrong the snapshot before it would be about its span.
  [[nodiscard]] double cost(size_t at) const {
    const size_t from = before_[at];
    const size_t width = series_.width();
    const auto told = series_.row(from);
    double max = 0;
    for (const ContentMember& member : series_.members) {
      double sum = 0;
      for (size_t i = member.first; i < member.first + member.width; ++i) {
        const double off = std::max(static_cast<double>(high_[at * width + i]) - told[i],
                                    static_cast<double>(told[i]) - low_[at * width + i]);
        sum += off * off;
      }
      max = std::max(max, std::sqrt(sum / static_cast<double>(member.width)));
    }
    max /= pace_;
    if (is_mixed_[at] || series_.facts[at] != series_.facts[from])
      max = std::max(max, kFactsSeconds);
    const double told_s = to_seconds(series_.times[last_[at]] - series_.times[from]);
    return std::max(max, told_s / kPausePerSecond);
  }

  void leave_out(size_t at) {
    const size_t to = before_[at], next = after_[at], width = series_.width();
    for (size_t i = 0; i < width; ++i) {
      low_[to * width + i] = std::min(low_[to * width + i], low_[at * width + i]);
      high_[to * width + i] = std::max(high_[to * width + i], high_[at * width + i]);
    }
    is_mixed_[to] = is_mixed_[to] || is_mixed_[at] || series_.facts[to] != series_.facts[at];
    last_[to] = last_[at];
    after_[to] = next;
    ++version_[at];
    renew(to);
    if (next >= series_.size()) return;
    before_[next] = to;
    renew(next);
  }

  void renew(size_t at) {
    if (at > 0) queue_.push({cost(at), at, ++version_[at]});
  }

  const ContentSeries& series_;
  std::vector<float> low_, high_;  ///< [N, D], of spans.
  std::vector<size_t> before_, after_, last_;
  std::vector<uint32_t> version_;
  std::vector<bool> is_mixed_;  ///< The facts of its span differ.
  double pace_ = 1;
  std::priority_queue<Step> queue_;
};

}  // namespace

double distance_of(const std::vector<ContentMember>& members, std::span<const float> a,
                   std::span<const float> b) {
  double max = 0;
  for (const ContentMember& member : members) {
    double sum = 0;
    for (size_t i = member.first; i < member.first + member.width; ++i) {
      const double off = static_cast<double>(a[i]) - b[i];
      sum += off * off;
    }
    max = std::max(max, std::sqrt(sum / static_cast<double>(member.width)));
  }
  return max;
}

double pace_of(const ContentSeries& series) {
  std::vector<double> steps;
  double path = 0;
  for (size_t i = 1; i < series.size(); ++i) {
    if (series.follows[i] == 0) continue;
    steps.push_back(to_seconds(series.times[i] - series.times[i - 1]));
    path += distance_of(series.members, series.row(i), series.row(i - 1));
  }
  if (steps.empty()) return kMinPace;
  const auto middle = steps.begin() + static_cast<ptrdiff_t>(steps.size() / 2);
  std::ranges::nth_element(steps, middle);
  const double max_step = kLongestStep * *middle;
  double seconds = 0;
  for (const double step : steps) seconds += std::min(step, max_step);
  return std::max(path / std::max(seconds, 1e-9), kMinPace);
}

double distance_of(const ContentSeries& series, size_t a, size_t b) {
  const double numbers = distance_of(series.members, series.row(a), series.row(b));
  return series.facts[a] == series.facts[b] ? numbers : std::max(numbers, 1.0);
}

std::vector<double> measure_change(const ContentSeries& series) {
  return BottomUp(series).run();
}

}  // namespace engram::ltm
