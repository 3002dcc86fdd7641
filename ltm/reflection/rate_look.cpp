// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "ltm/reflection/looks.h"
#include "ltm/reflection/robust.h"

namespace engram::ltm {

namespace {

/// Snapshots that are needed to say what is usual.
constexpr size_t kMinSnapshots = 20;
/// Share of steps that lie near the median where a rate is steady.
constexpr double kSteadyShare = 0.7;
/// How near, as a share of the median.
constexpr double kSteadyWithin = 0.3;
/// A step of more than so many usual ones is a gap.
constexpr double kGapSteps = 1.75;
/// Steps from so many usual ones on, several in a row, are a slower rate.
constexpr double kSlowSteps = 1.4;
/// Above this a step is a gap, whatever lies around it.
constexpr double kMaxSlowSteps = 6;
constexpr size_t kMinSlowRun = 4;
/// Steps below this share of the usual one, several in a row, are a faster rate.
constexpr double kFastSteps = 0.65;
constexpr size_t kMinFastRun = 10;
/// Missing snapshots from which on a gap is a fault.
constexpr uint64_t kFaultMissing = 3;

std::string hz_text(double step_s) {
  return step_s >= 1 ? fmt::format("one in {:.3g} s", step_s)
                     : fmt::format("{:.3g} Hz", 1 / step_s);
}

/// The steps of an entity and what is usual of them.
class Steps {
 public:
  Steps(const std::vector<int64_t>& times, EntityReflection& entity)
      : times_(times), entity_(entity) {
    for (size_t i = 1; i < times.size(); ++i)
      steps_.push_back(static_cast<double>(times[i] - times[i - 1]) * 1e-9);
    if (steps_.empty()) return;
    const std::vector<double> sample = spread_sample(steps_, 65536);
    usual_ = quantile(sample, 0.5);
    const auto near = [this](double step) {
      return std::abs(step - usual_) <= kSteadyWithin * usual_;
    };
    is_steady_ =
        times.size() >= kMinSnapshots && static_cast<double>(std::ranges::count_if(sample, near)) >=
                                             kSteadyShare * static_cast<double>(sample.size());
    // Where the rate is jittery, a late snapshot is no gap.
    late_ = std::max(kGapSteps * usual_, 1.25 * quantile(sample, 0.98));
    if (late_ > 4 * usual_) late_ = 4 * usual_;
  }

  [[nodiscard]] bool is_steady() const { return is_steady_; }
  [[nodiscard]] double usual() const { return usual_; }

  void find_runs(FindingList& findings) {
    is_in_run_.assign(steps_.size(), false);
    find_run(kMinSlowRun, findings, [this](double step) {
      return step > kSlowSteps * usual_ && step < kMaxSlowSteps * usual_;
    });
    find_run(kMinFastRun, findings, [this](double step) { return step < kFastSteps * usual_; });
  }

  void find_gaps(std::vector<PossibleGap>& gaps) const {
    for (size_t i = 0; i < steps_.size(); ++i) {
      if (is_in_run_[i] || steps_[i] <= late_) continue;
      if (gaps.size() >= kMaxPossibleGaps) return;
      const auto missing = static_cast<uint64_t>(std::max(0.0, std::round(steps_[i] / usual_) - 1));
      gaps.push_back({entity_.id, times_[i], times_[i + 1], missing, usual_});
    }
  }

 private:
  template <typename IsOdd>
  void find_run(size_t min_run, FindingList& findings, const IsOdd& is_odd) {
    for (size_t first = 0; first < steps_.size();) {
      size_t end = first;
      while (end < steps_.size() && is_odd(steps_[end])) ++end;
      if (end - first >= min_run) add_run(first, end, findings);
      first = std::max(end, first + 1);
    }
  }

  void add_run(size_t first, size_t end, FindingList& findings) {
    std::fill(is_in_run_.begin() + static_cast<ptrdiff_t>(first),
              is_in_run_.begin() + static_cast<ptrdiff_t>(end), true);
    const double mean =
        static_cast<double>(times_[end] - times_[first]) * 1e-9 / static_cast<double>(end - first);
    findings.add({ReflectionKind::kRate, Severity::kFault, entity_.id, "",
                  time_from_ns(times_[first]), time_from_ns(times_[end]), end - first,
                  fmt::format("{} snapshots at {}", end - first, hz_text(mean)), hz_text(usual_)},
                 Duration(0));
  }

  const std::vector<int64_t>& times_;
  EntityReflection& entity_;
  std::vector<double> steps_;
  std::vector<bool> is_in_run_;
  double usual_ = 0;
  double late_ = 0;
  bool is_steady_ = false;
};

/// Events have no rate. Only a pause that is far beyond all others is worth a note.
void look_at_events(const std::vector<int64_t>& times, EntityReflection& entity,
                    std::vector<PossibleGap>& gaps) {
  constexpr size_t kMinEvents = 40;
  if (times.size() < kMinEvents) return;
  entity.looked_at.insert(ReflectionKind::kGap);
  std::vector<double> logs;
  for (size_t i = 1; i < times.size(); ++i)
    logs.push_back(std::log(std::max<double>(1, static_cast<double>(times[i] - times[i - 1]))));
  const std::vector<double> sample = spread_sample(logs, 65536);
  const double low = quantile(sample, 0.25), high = quantile(sample, 0.75);
  const double limit = high + 4 * std::max(high - low, std::log(2.0));
  for (size_t i = 0; i < logs.size(); ++i)
    if (logs[i] > limit && gaps.size() < kMaxPossibleGaps)
      gaps.push_back(
          {entity.id, times[i], times[i + 1], 0, std::exp(quantile(sample, 0.5)) * 1e-9});
}

}  // namespace

void look_at_rates(const std::vector<int64_t>& times, EntityReflection& entity,
                   FindingList& findings, std::vector<PossibleGap>& gaps) {
  entity.snapshots = times.size();
  if (times.empty()) return;
  entity.first = time_from_ns(times.front());
  entity.last = time_from_ns(times.back());
  Steps steps(times, entity);
  entity.is_periodic = steps.is_steady();
  if (!steps.is_steady()) return look_at_events(times, entity, gaps);
  entity.median_step_s = steps.usual();
  entity.looked_at.insert({ReflectionKind::kGap, ReflectionKind::kRate});
  steps.find_runs(findings);
  steps.find_gaps(gaps);
}

}  // namespace engram::ltm
