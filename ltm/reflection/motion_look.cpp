// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <tuple>

#include "ltm/reflection/looks.h"
#include "ltm/reflection/robust.h"

namespace engram::ltm {

namespace {

constexpr size_t kMinMotionRows = 12;
/// Speeds that are compared between entities are cut at so many of the largest usual ones.
constexpr double kMaxKeptSpeeds = 1.5;
/// Steps below this share of the size of a member are rounding and settling.
constexpr double kNoiseShare = 1e-4;
/// The same where nothing of the provider segment moves, so that nobody knows what is fast.
constexpr double kUnknownShare = 5e-2;
/// A spike goes away and back faster than so many of the largest usual speeds.
constexpr double kSpikeSpeeds = 1.0;
/// A jump is a step of more than so many of the largest usual speeds, and of its neighbours'.
constexpr double kJumpSpeeds = 2;
constexpr double kJumpNeighbours = 3;
/// The largest speeds of an element, which do not count in what is usual.
constexpr size_t kLargestLeftOut = 5;
/// Moments in motion from which on an element says by itself what is usual; else its provider
/// segment does.
constexpr size_t kManyMoving = 400;
/// Moments in motion from which on an element counts in its provider segment.
constexpr size_t kSomeMoving = 24;
/// One element of a member over time, its angles unwound.
class ElementMotion {
 public:
  ElementMotion(const SeriesBlock& block, const NumberColumn& column, size_t element)
      : block_(block), column_(column) {
    const size_t count = column.rows.size();
    speeds_.assign(count, 0.0);
    for (size_t i = 1; i < count; ++i) {
      const double dt =
          std::max(1e-9 * static_cast<double>(time(i) - time(i - 1)), 0.3 * block.step_s);
      speeds_[i] = step(i, element) / dt;
      if (!std::isfinite(speeds_[i])) speeds_[i] = 0;
    }
    std::vector<double> moving;
    for (const double speed : speeds_)
      if (speed != 0) moving.push_back(std::abs(speed));
    moving_ = moving.size();
    std::vector<double> sample = spread_sample(moving);
    usual_ = quantile(sample, 0.9);
    // A few faults would make themselves usual where there is little motion.
    std::ranges::sort(sample);
    const size_t left_out =
        std::max(kLargestLeftOut, moving_ < kManyMoving ? sample.size() / 10 : 0);
    sample.resize(sample.size() - std::min(sample.size(), left_out));
    fast_ = quantile(std::move(sample), 0.99);
  }

  [[nodiscard]] int64_t time(size_t i) const { return block_.times[column_.rows[i]]; }
  [[nodiscard]] const std::vector<double>& speeds() const { return speeds_; }
  [[nodiscard]] double fast() const { return fast_; }
  [[nodiscard]] double usual() const { return usual_; }
  [[nodiscard]] size_t moving() const { return moving_; }

  /// Quantile 0.99 of the third difference over time, while it moves.
  [[nodiscard]] double jerk() const {
    std::vector<double> jerks;
    const double dt = block_.step_s;
    for (size_t i = 3; i < speeds_.size(); ++i)
      if (speeds_[i] != 0)
        jerks.push_back(std::abs(speeds_[i] - 2 * speeds_[i - 1] + speeds_[i - 2]) / (dt * dt));
    return quantile(spread_sample(jerks), 0.99);
  }

 private:
  /// Angles that pass the end of their range come back at its begin, and both signs of a
  /// quaternion mean the same.
  [[nodiscard]] double step(size_t i, size_t element) const {
    const double before = column_.at(i - 1, element), now = column_.at(i, element);
    double step = now - before;
    if (column_.meaning == NumberColumn::Meaning::kOrientation) {
      double product = 0;
      for (size_t k = 0; k < column_.width; ++k) product += column_.at(i, k) * column_.at(i - 1, k);
      return product < 0 ? -now - before : step;
    }
    constexpr double kTurn = 2 * std::numbers::pi;
    if (std::abs(step) > std::numbers::pi && std::abs(now) <= kTurn && std::abs(before) <= kTurn)
      if (const double rest = std::remainder(step, kTurn); std::abs(rest) < 0.3) step = rest;
    return step;
  }

  const SeriesBlock& block_;
  const NumberColumn& column_;
  std::vector<double> speeds_;
  double fast_ = 0;
  double usual_ = 0;
  size_t moving_ = 0;
};

/// The speeds of an element, and the largest usual one.
struct MovingElement {
  double fast = 0;
  std::string path;
  size_t index = 0;
  std::vector<double> speeds;
};

class MotionLook {
 public:
  MotionLook(const SeriesBlock& block, EntityReflection& entity, SpeedPool& pool,
             std::vector<PossibleJump>& jumps)
      : block_(block), entity_(entity), pool_(pool), jumps_(jumps), moved_(block.rows(), false) {}

  void look_at(const NumberColumn& column, bool may_not_jump) {
    MemberReflection& member = member_of(column);
    member.is_motion = true;
    size_ = size_of(column);
    for (size_t k = 0; k < column.width; ++k) {
      const ElementMotion motion(block_, column, k);
      if (motion.moving() == 0) continue;
      entity_.has_motion = true;
      member.speed = std::max(member.speed, motion.fast());
      member.jerk = std::max(member.jerk, motion.jerk());
      if (may_not_jump) find_jumps(motion, column, k);
      note_motion(motion, column, k, may_not_jump);
      if (motion.moving() < kSomeMoving || motion.fast() * block_.step_s <= kNoiseShare * size_)
        continue;
      double& pooled = pool_[{block_.entity.parent(), column.path}];
      pooled = std::max(pooled, motion.fast());
    }
  }

  void describe(const NumberColumn& column) {
    MemberReflection& member = member_of(column);
    if (!member.low.empty()) return;  // The first block says enough.
    for (size_t k = 0; k < column.width; ++k) {
      std::vector<double> values;
      for (size_t i = 0; i < column.rows.size(); ++i)
        if (std::isfinite(column.at(i, k))) values.push_back(column.at(i, k));
      const std::vector<double> sample = spread_sample(values, 4096);
      member.low.push_back(quantile(sample, 0.05));
      member.middle.push_back(quantile(sample, 0.5));
      member.high.push_back(quantile(sample, 0.95));
    }
  }

  /// Idle time, from what moved at each row, and the motion of the fastest elements.
  void finish(EntityMotion& motion) {
    const size_t rows_before = motion.times.size();
    if (!entity_.has_motion || block_.rows() < 2) return;
    int64_t idle = 0, longest = 0, current = 0;
    for (size_t i = 1; i < block_.rows(); ++i) {
      const int64_t step = block_.times[i] - block_.times[i - 1];
      current = moved_[i] ? 0 : current + step;
      idle += moved_[i] ? 0 : step;
      longest = std::max(longest, current);
    }
    const auto all = static_cast<double>(block_.times.back() - block_.times.front());
    const double share = all > 0 ? static_cast<double>(idle) / all : 1.0;
    // Over all blocks of the entity: what was known before counts as often as it is long.
    const double weight =
        static_cast<double>(block_.rows()) / static_cast<double>(rows_before + block_.rows());
    entity_.idle_share =
        rows_before == 0 ? share : entity_.idle_share + weight * (share - entity_.idle_share);
    entity_.longest_idle_s = std::max(entity_.longest_idle_s, 1e-9 * static_cast<double>(longest));
    keep_motion(motion);
  }

 private:
  /// How large the numbers of a member are.
  static double size_of(const NumberColumn& column) {
    std::vector<double> sizes = spread_sample(column.values);
    std::erase_if(sizes, [](double value) { return !std::isfinite(value); });
    for (double& value : sizes) value = std::abs(value);
    return quantile(std::move(sizes), 0.95);
  }

  MemberReflection& member_of(const NumberColumn& column) {
    for (MemberReflection& known : entity_.members)
      if (known.path == column.path) return known;
    return entity_.members.emplace_back(MemberReflection{column.path, column.unit});
  }

  void note_motion(const ElementMotion& motion, const NumberColumn& column, size_t element,
                   bool is_kept) {
    const double begin = kMovingShare * motion.fast();
    for (size_t i = 1; i < column.rows.size(); ++i)
      if (std::abs(motion.speeds()[i]) > begin) moved_[column.rows[i]] = true;
    if (!is_kept || column.rows.size() != block_.rows() || motion.fast() <= 0) return;
    // A single leap would outweigh all motion.
    std::vector<double> speeds = motion.speeds();
    for (double& speed : speeds)
      speed = std::clamp(speed, -kMaxKeptSpeeds * motion.fast(), kMaxKeptSpeeds * motion.fast());
    moving_.push_back({motion.fast(), column.path, element, std::move(speeds)});
  }

  /// The first block decides which elements are kept.
  void keep_motion(EntityMotion& kept) {
    if (block_.instance != 0 || kept.times.size() >= EntityMotion::kMaxMotionRows) return;
    if (kept.times.empty()) {
      std::ranges::stable_sort(moving_, std::greater(), &MovingElement::fast);
      for (const MovingElement& element : moving_)
        if (kept.elements.size() < EntityMotion::kMaxMotionElements)
          kept.elements.push_back({element.path, element.index, {}});
    }
    kept.times.insert(kept.times.end(), block_.times.begin(), block_.times.end());
    for (EntityMotion::Element& element : kept.elements) {
      for (const MovingElement& found : moving_)
        if (found.path == element.path && found.index == element.index)
          element.speeds.insert(element.speeds.end(), found.speeds.begin(), found.speeds.end());
      element.speeds.resize(kept.times.size());
    }
  }

  void find_jumps(const ElementMotion& motion, const NumberColumn& column, size_t element) {
    const std::vector<double>& v = motion.speeds();
    const double fast = motion.fast();
    for (size_t i = 1; i < v.size(); ++i) {
      const double now = std::abs(v[i]);
      const auto step_at = [&](size_t at) {
        const double dt = 1e-9 * static_cast<double>(motion.time(at) - motion.time(at - 1));
        return std::abs(v[at]) * std::max(dt, 0.3 * block_.step_s);
      };
      const double step = step_at(i);
      if (now <= kSpikeSpeeds * fast || step <= kNoiseShare * size_) continue;
      const double before = i > 1 ? std::abs(v[i - 1]) : 0;
      const double after = i + 1 < v.size() ? std::abs(v[i + 1]) : 0;
      // It comes back by as much as it went away, however long that took.
      const double back = i + 1 < v.size() ? step_at(i + 1) : 0;
      if (back > 0 && v[i] * v[i + 1] < 0 && after > kSpikeSpeeds * fast &&
          std::min(step, back) > 0.5 * std::max(step, back)) {
        add(ReflectionKind::kSpike, motion, column, element, i, std::min(now, after), step);
        ++i;
      } else if (now > kJumpSpeeds * fast && now > kJumpNeighbours * std::max(before, after)) {
        add(ReflectionKind::kJump, motion, column, element, i, now, step);
      }
    }
  }

  void add(ReflectionKind kind, const ElementMotion& motion, const NumberColumn& column,
           size_t element, size_t i, double speed, double step) {
    constexpr size_t kMaxJumps = 100'000;
    if (jumps_.size() >= kMaxJumps) return;
    const size_t first = kind == ReflectionKind::kSpike ? i : i - 1;
    const std::string unit = column.unit.empty() ? "" : " " + column.unit;
    ReflectionFinding finding{kind,
                              Severity::kFault,
                              block_.entity,
                              column.element_name(element),
                              time_from_ns(motion.time(first)),
                              time_from_ns(motion.time(i))};
    finding.found = fmt::format("from {:.4g} to {:.4g}{} in {:.3g} s{}", column.at(i - 1, element),
                                column.at(i, element), unit,
                                1e-9 * static_cast<double>(motion.time(i) - motion.time(i - 1)),
                                kind == ReflectionKind::kSpike ? " and back" : "");
    jumps_.push_back({std::move(finding), column.path, speed, motion.fast(),
                      motion.moving() < kManyMoving, step > kUnknownShare * size_});
  }

  const SeriesBlock& block_;
  EntityReflection& entity_;
  SpeedPool& pool_;
  std::vector<PossibleJump>& jumps_;
  double size_ = 0;  ///< Of the member that is looked at.
  std::vector<bool> moved_;
  std::vector<MovingElement> moving_;
};

}  // namespace

void look_at_motion(const SeriesBlock& block, const std::vector<ChangePair>& pairs,
                    EntityReflection& entity, SpeedPool& pool, std::vector<PossibleJump>& jumps,
                    EntityMotion& motion) {
  MotionLook look(block, entity, pool, jumps);
  for (size_t i = 0; i < block.numbers.size(); ++i) {
    const NumberColumn& column = block.numbers[i];
    if (column.rows.empty()) continue;
    look.describe(column);
    if (column.is_discrete() || !block.is_periodic || column.rows.size() < kMinMotionRows) continue;
    entity.looked_at.insert({ReflectionKind::kSpike, ReflectionKind::kJump});
    look.look_at(column, std::ranges::find(pairs, i, &ChangePair::change) == pairs.end());
  }
  if (block.is_periodic) look.finish(motion);
}

void judge_jumps(const SpeedPool& pool, std::vector<PossibleJump>& jumps, FindingList& findings) {
  // By entity, member, kind and begin: what moves several elements at once is one finding.
  std::map<std::tuple<MemoryId, std::string, ReflectionKind, Time>, std::vector<ReflectionFinding>>
      found;
  for (PossibleJump& jump : jumps) {
    const auto known = pool.find({jump.finding.entity.parent(), jump.member});
    const double pooled = known == pool.end() ? 0 : known->second;
    const double fast = jump.needs_pool ? std::max(jump.fast, pooled) : jump.fast;
    const bool is_spike = jump.finding.kind == ReflectionKind::kSpike;
    // An entity that never moves but for this step has no other measure than its own size.
    if (jump.needs_pool && pooled <= 0 && !jump.is_large) continue;
    if (jump.speed < (is_spike ? kSpikeSpeeds : kJumpSpeeds) * fast) continue;
    jump.finding.expected = fmt::format("max {:.3g} in a second", fast);
    found[{jump.finding.entity, jump.member, jump.finding.kind, jump.finding.first}].push_back(
        std::move(jump.finding));
  }
  jumps.clear();
  for (auto& [key, elements] : found) {
    ReflectionFinding& first = elements.front();
    constexpr size_t kMaxElementsTold = 3;
    if (elements.size() > kMaxElementsTold) {
      first.found = fmt::format("{} of its elements leap at once; {} {}", elements.size(),
                                first.member, first.found);
      first.member = std::get<1>(key);
      elements.resize(1);
    }
    for (ReflectionFinding& finding : elements)
      findings.add(std::move(finding), std::chrono::milliseconds(100));
  }
}

}  // namespace engram::ltm
