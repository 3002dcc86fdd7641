// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "ltm/reflection/looks.h"
#include "ltm/reflection/robust.h"

namespace engram::ltm {

namespace {

constexpr size_t kMinDriftRows = 50;
/// Correlation from which on a member is the change of another.
constexpr double kChangeCorrelation = 0.9;
/// What a member may leave the integral of its change by, as a share of its range.
constexpr double kDriftShare = 0.03;
/// The same in random steps of its own noise.
constexpr double kDriftNoise = 8;
/// What stands still must have had to move by, as a share of its range.
constexpr double kStuckShare = 0.01;
constexpr size_t kMinStuckRows = 5;
/// Time in which drift shows.
constexpr double kDriftWindowS = 60;
/// A step of a slow creep lasts and is even.
constexpr size_t kMinCreepRows = 20;
constexpr double kMinCreepS = 4;
constexpr double kCreepEvenness = 2.5;
constexpr double kMinClockDriftS = 0.02;
/// Changes below this share of the fastest element's are noise.
constexpr double kMinChangeShare = 0.02;

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const auto n = static_cast<double>(a.size());
  double sa = 0, sb = 0, saa = 0, sbb = 0, sab = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    sa += a[i];
    sb += b[i];
    saa += a[i] * a[i];
    sbb += b[i] * b[i];
    sab += a[i] * b[i];
  }
  const double va = saa - sa * sa / n, vb = sbb - sb * sb / n;
  return va > 0 && vb > 0 ? (sab - sa * sb / n) / std::sqrt(va * vb) : 0;
}

double unwound(double step) {
  constexpr double kWholeTurn = 2 * std::numbers::pi;
  if (std::abs(step) <= std::numbers::pi || std::abs(step) > 1.1 * kWholeTurn) return step;
  const double rest = std::remainder(step, kWholeTurn);
  return std::abs(rest) < 0.3 ? rest : step;
}

/// Compares a member with the one that is its change over time.
class ChangeLook {
 public:
  ChangeLook(const SeriesBlock& block, const NumberColumn& value, const NumberColumn& change)
      : block_(block), value_(value), change_(change) {}

  [[nodiscard]] bool is_pair() const {
    if (value_.width != change_.width || value_.rows != change_.rows) return false;
    std::vector<double> found;
    for (size_t k = 0; k < value_.width; ++k) {
      constexpr size_t kSamples = 2000;
      std::vector<double> steps, changes;
      const size_t stride = std::max<size_t>(1, value_.rows.size() / kSamples);
      for (size_t i = 1; i + 1 < value_.rows.size(); i += stride) {
        const double dt = seconds(i - 1, i + 1);
        const double step = unwound(value_.at(i + 1, k) - value_.at(i - 1, k));
        if (dt > 6 * block_.step_s || !std::isfinite(step) || !std::isfinite(change_.at(i, k)))
          continue;
        steps.push_back(step / dt);
        changes.push_back(change_.at(i, k));
      }
      if (steps.size() < kMinDriftRows) continue;
      const double size_a = quantile(absolute(steps), 0.95),
                   size_b = quantile(absolute(changes), 0.95);
      if (size_a <= 0 || size_b <= 0) continue;
      // A few leaps must not hide that two members belong together.
      for (double& step : steps) step = std::clamp(step, -1.5 * size_b, 1.5 * size_b);
      for (double& change : changes) change = std::clamp(change, -1.5 * size_b, 1.5 * size_b);
      const double together = correlation(steps, changes);
      found.push_back(size_a > 0.7 * size_b && size_b > 0.7 * size_a ? together : 0);
    }
    return !found.empty() && quantile(std::move(found), 0.4) > kChangeCorrelation;
  }

  void look_at(FindingList& findings) {
    std::vector<double> ranges, moving;
    for (size_t k = 0; k < value_.width; ++k) {
      ranges.push_back(range(k));
      if (ranges.back() > 1e-4) moving.push_back(ranges.back());
    }
    const double usual = quantile(std::move(moving), 0.5);
    for (size_t k = 0; k < value_.width; ++k) {
      look_at(k, std::max(ranges[k], 0.5 * usual), findings);
    }
    double fastest = 0;
    for (size_t k = 0; k < change_.width; ++k) fastest = std::max(fastest, fast_change(k));
    for (size_t k = 0; k < change_.width; ++k)
      find_wrong_changes(k, kMinChangeShare * fastest, findings);
  }

 private:
  static std::vector<double> absolute(std::vector<double> values) {
    for (double& value : values) value = std::abs(value);
    return values;
  }

  [[nodiscard]] int64_t time(size_t i) const { return block_.times[value_.rows[i]]; }
  [[nodiscard]] double seconds(size_t from, size_t to) const {
    return 1e-9 * static_cast<double>(time(to) - time(from));
  }
  [[nodiscard]] double range(size_t k) const {
    std::vector<double> values;
    const size_t stride = std::max<size_t>(1, value_.rows.size() / 4096);
    for (size_t i = 0; i < value_.rows.size(); i += stride)
      if (std::isfinite(value_.at(i, k))) values.push_back(value_.at(i, k));
    return quantile(values, 0.99) - quantile(values, 0.01);
  }

  void look_at(size_t k, double range, FindingList& findings) {
    const size_t count = value_.rows.size();
    std::vector<double> excess(count, 0.0);  // By how much a step is more than its change says.
    std::vector<double> sizes;
    for (size_t i = 1; i < count; ++i) {
      const double dt = seconds(i - 1, i);
      const double step = unwound(value_.at(i, k) - value_.at(i - 1, k));
      const double more = step - dt * (change_.at(i, k) + change_.at(i - 1, k)) / 2;
      if (dt <= 4 * block_.step_s && std::isfinite(more)) excess[i] = more;
      sizes.push_back(std::abs(excess[i]));
    }
    const double noise = 1.5 * quantile(spread_sample(sizes), 0.5);
    find_stuck(k, range, noise, excess, findings);
    // A jump is no drift.
    const double large = std::max(0.5 * kDriftShare * range, 20 * noise);
    std::vector<double> sums(count, 0.0);
    for (size_t i = 1; i < count; ++i)
      sums[i] = sums[i - 1] + (std::abs(excess[i]) < large ? excess[i] : 0);
    find_drift(k, range, noise, sums, findings);
  }

  [[nodiscard]] double fast_change(size_t k) const {
    std::vector<double> sizes;
    const size_t stride = std::max<size_t>(1, change_.rows.size() / 8192);
    for (size_t i = 0; i < change_.rows.size(); i += stride)
      if (std::isfinite(change_.at(i, k))) sizes.push_back(std::abs(change_.at(i, k)));
    return quantile(std::move(sizes), 0.995);
  }

  /// A change that the values around it know nothing of.
  void find_wrong_changes(size_t k, double min_misfit, FindingList& findings) const {
    const size_t count = value_.rows.size();
    std::vector<double> misfits(count, 0.0);
    for (size_t i = 1; i + 1 < count; ++i) {
      const double dt = seconds(i - 1, i + 1);
      const double before = unwound(value_.at(i, k) - value_.at(i - 1, k));
      const double after = unwound(value_.at(i + 1, k) - value_.at(i, k));
      const double misfit = change_.at(i, k) - (before + after) / dt;
      // Where the value itself leaps, nothing is wrong with its change.
      const double leap = std::abs(after - before) / dt;
      if (dt < 4 * block_.step_s && std::isfinite(misfit) && leap < 0.5 * std::abs(misfit))
        misfits[i] = misfit;
    }
    std::vector<double> sample = spread_sample(misfits);
    for (double& misfit : sample) misfit = std::abs(misfit);
    const double limit =
        std::max({min_misfit, fast_change(k), 12 * quantile(std::move(sample), 0.98)});
    if (limit <= 0) return;
    for (size_t i = 1; i + 1 < count; ++i)
      if (std::abs(misfits[i]) > limit)
        findings.add({ReflectionKind::kSpike, Severity::kFault, block_.entity,
                      change_.element_name(k), time_from_ns(time(i)), time_from_ns(time(i)), 1,
                      fmt::format("{:.4g}", change_.at(i, k)),
                      fmt::format("{:.4g}, as {} changes", change_.at(i, k) - misfits[i],
                                  value_.element_name(k))},
                     std::chrono::milliseconds(100));
  }

  /// Elements that have the same value again and again, though their change says otherwise.
  void find_stuck(size_t k, double range, double noise, const std::vector<double>& excess,
                  FindingList& findings) const {
    for (size_t i = 1; i < excess.size();) {
      size_t end = i;
      double missed = 0;
      while (end < excess.size() && value_.at(end, k) == value_.at(end - 1, k))
        missed += excess[end++];
      const auto rows = static_cast<double>(end - i);
      if (end - i >= kMinStuckRows && std::abs(missed) > kStuckShare * range &&
          std::abs(missed) > kDriftNoise * noise * std::sqrt(rows))
        findings.add(
            {ReflectionKind::kFrozen, Severity::kFault, block_.entity, value_.element_name(k),
             time_from_ns(time(i - 1)), time_from_ns(time(end - 1)), end - i + 1,
             fmt::format("the same value in {} snapshots", end - i + 1),
             fmt::format("a change by {:.3g}, as {} says", -missed, change_.element_name(k))});
      i = std::max(end, i + 1);
    }
  }

  void find_drift(size_t k, double range, double noise, const std::vector<double>& sums,
                  FindingList& findings) const {
    const auto window = static_cast<size_t>(
        std::max<double>(kMinDriftRows, kDriftWindowS / std::max(block_.step_s, 1e-6)));
    const double limit =
        std::max(kDriftShare * range, kDriftNoise * noise * std::sqrt(static_cast<double>(window)));
    for (size_t first = 0; first + 1 < sums.size(); first += window / 2) {
      const size_t end = std::min(sums.size(), first + window);
      const auto [low, high] = std::minmax_element(sums.begin() + static_cast<ptrdiff_t>(first),
                                                   sums.begin() + static_cast<ptrdiff_t>(end));
      if (*high - *low <= limit) {
        if (end == sums.size()) break;
        continue;
      }
      size_t from = static_cast<size_t>(std::min(low, high) - sums.begin());
      size_t to = static_cast<size_t>(std::max(low, high) - sums.begin());
      const double all = sums[to] - sums[from];
      size_t start = from;
      while (start < to && std::abs(sums[start] - sums[from]) < 0.05 * std::abs(all)) ++start;
      size_t stop = to;
      while (stop > start && std::abs(sums[to] - sums[stop]) < 0.05 * std::abs(all)) --stop;
      const Time begins = time_from_ns(time(start)), ends = time_from_ns(time(stop));
      // What stands still is told of already.
      if (!findings.has(ReflectionKind::kFrozen, block_.entity, begins, ends))
        findings.add({ReflectionKind::kDrift, Severity::kFault, block_.entity,
                      value_.element_name(k), begins, ends, 1,
                      fmt::format("{:+.3g} in {:.3g} s more than {} says", all,
                                  to_seconds(ends - begins), change_.element_name(k)),
                      fmt::format("less than {:.2g}", limit)},
                     std::chrono::seconds(5));
      if (end == sums.size()) break;
    }
  }

  const SeriesBlock& block_;
  const NumberColumn& value_;
  const NumberColumn& change_;
};

/// Slow motion of one element at an even pace while the others rest: nothing moves like that.
void find_creep(const SeriesBlock& block, const NumberColumn& column, FindingList& findings) {
  const size_t count = column.rows.size();
  for (size_t k = 0; k < column.width; ++k) {
    for (size_t i = 1; i < count;) {
      size_t end = i;
      std::vector<double> speeds;
      while (end < count) {
        const double dt = 1e-9 * static_cast<double>(block.times[column.rows[end]] -
                                                     block.times[column.rows[end - 1]]);
        const double step = column.at(end, k) - column.at(end - 1, k);
        bool is_alone = std::isfinite(step) && step != 0 && dt < 4 * block.step_s;
        for (size_t other = 0; is_alone && other < column.width; ++other)
          is_alone = other == k || std::abs(column.at(end, other) - column.at(end - 1, other)) <
                                       0.02 * std::abs(step);
        if (!is_alone || (!speeds.empty() && speeds.front() * step < 0)) break;
        speeds.push_back(step / dt);
        ++end;
      }
      const double pace = quantile(speeds, 0.5);
      const double rows = static_cast<double>(speeds.size());
      const auto uneven = std::ranges::count_if(speeds, [pace](double speed) {
        return std::abs(speed) > kCreepEvenness * std::abs(pace) ||
               std::abs(pace) > kCreepEvenness * std::abs(speed);
      });
      if (speeds.size() >= kMinCreepRows && rows * block.step_s >= kMinCreepS &&
          static_cast<double>(uneven) < 0.1 * rows) {
        const Time first = time_from_ns(block.times[column.rows[i - 1]]);
        const Time last = time_from_ns(block.times[column.rows[end - 1]]);
        findings.add(
            {ReflectionKind::kDrift, Severity::kFault, block.entity, column.element_name(k), first,
             last, speeds.size(),
             fmt::format("{:+.3g} in {:.3g} s at an even pace",
                         column.at(end - 1, k) - column.at(i - 1, k), to_seconds(last - first)),
             "rest, or motion of the others too"});
      }
      i = std::max(end, i + 1);
    }
  }
}

void look_at_clock(const SeriesBlock& block, EntityReflection& entity, FindingList& findings) {
  const size_t count = block.latencies.size();
  if (count < kMinDriftRows) return;
  std::vector<double> seconds;
  for (const int64_t latency : block.latencies)
    seconds.push_back(1e-9 * static_cast<double>(latency));
  const double usual = quantile(spread_sample(seconds), 0.5);
  entity.latency_s = entity.latency_s.value_or(usual);
  // Recordings that were imported arrived long after they were made: that says nothing.
  constexpr double kMaxLatencyS = 600;
  const auto [low, high] = std::ranges::minmax_element(seconds);
  if (std::abs(usual) > kMaxLatencyS || *low == *high) return;
  entity.looked_at.insert(ReflectionKind::kClockDrift);
  std::vector<double> thirds;
  std::vector<double> spreads;
  for (size_t i = 0; i < 3; ++i) {
    const std::vector<double> third(seconds.begin() + static_cast<ptrdiff_t>(i * count / 3),
                                    seconds.begin() + static_cast<ptrdiff_t>((i + 1) * count / 3));
    thirds.push_back(quantile(spread_sample(third), 0.5));
    spreads.push_back(quantile(spread_sample(third), 0.75) - quantile(spread_sample(third), 0.25));
  }
  const double change = 1.5 * (thirds[2] - thirds[0]);
  const bool is_steady =
      (thirds[1] - thirds[0]) * (thirds[2] - thirds[1]) > 0 &&
      std::abs(thirds[1] - (thirds[0] + thirds[2]) / 2) < 0.25 * std::abs(change);
  if (!is_steady || std::abs(change) < kMinClockDriftS ||
      std::abs(change) < 3 * *std::ranges::min_element(spreads))
    return;
  findings.add({ReflectionKind::kClockDrift, Severity::kFault, block.entity, "",
                time_from_ns(block.times.front()), time_from_ns(block.times.back()), count,
                fmt::format("its arrival lags {:+.3g} s more at the end than at the begin", change),
                "the same delay all the time"});
}

}  // namespace

std::vector<ChangePair> find_change_pairs(const SeriesBlock& block) {
  std::vector<ChangePair> pairs;
  if (!block.is_periodic) return pairs;
  const auto can_move = [](const NumberColumn& column) {
    return column.meaning == NumberColumn::Meaning::kQuantity &&
           column.rows.size() >= kMinDriftRows;
  };
  for (size_t value = 0; value < block.numbers.size(); ++value)
    for (size_t change = 0; change < block.numbers.size(); ++change) {
      if (change == value || !can_move(block.numbers[value]) || !can_move(block.numbers[change]))
        continue;
      if (!ChangeLook(block, block.numbers[value], block.numbers[change]).is_pair()) continue;
      pairs.push_back({value, change});
      break;
    }
  return pairs;
}

void look_at_drift(const SeriesBlock& block, const std::vector<ChangePair>& pairs,
                   EntityReflection& entity, FindingList& findings) {
  if (!block.is_periodic) return;
  look_at_clock(block, entity, findings);
  for (const ChangePair& pair : pairs)
    ChangeLook(block, block.numbers[pair.value], block.numbers[pair.change]).look_at(findings);
  for (size_t i = 0; i < block.numbers.size(); ++i) {
    const NumberColumn& value = block.numbers[i];
    if (value.is_discrete() || value.rows.size() < kMinDriftRows) continue;
    entity.looked_at.insert(ReflectionKind::kDrift);
    const bool is_in_pair = std::ranges::any_of(
        pairs, [i](const ChangePair& pair) { return pair.value == i || pair.change == i; });
    if (!is_in_pair && value.meaning == NumberColumn::Meaning::kQuantity && value.width > 1)
      find_creep(block, value, findings);
  }
}

}  // namespace engram::ltm
