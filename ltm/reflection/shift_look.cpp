// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "ltm/reflection/looks.h"

namespace engram::ltm {

namespace {

constexpr double kGridS = 0.02;
constexpr int kMaxLag = 50;  ///< In steps of the grid.
constexpr size_t kMaxWindowSteps = 1500;
constexpr size_t kMinWindowSteps = 400;
/// Windows of a pair that are compared, those with the most motion.
constexpr size_t kMaxWindows = 12;
/// Windows that decide which elements of two entities belong together.
constexpr size_t kChosenWindows = 3;
/// Elements that belong together correlate at least so much.
constexpr double kMinTogether = 0.75;
/// A shift explains the motion better by at least so much, and lasts at least so long.
constexpr double kMinGain = 0.02;
constexpr double kMinShiftS = 0.06;

/// A piece of motion on the grid, with room for lags at both ends.
using Grid = std::vector<float>;

/// The speed of an element at the moments of a grid; speeds belong to the middle of their step.
Grid on_grid(const EntityMotion& motion, const EntityMotion::Element& element, int64_t first_ns,
             size_t steps) {
  Grid grid(steps, 0.0F);
  const std::vector<int64_t>& times = motion.times;
  size_t at = static_cast<size_t>(std::ranges::lower_bound(times, first_ns) - times.begin());
  at = std::max<size_t>(at, 1);
  const auto middle = [&times](size_t i) {
    return 0.5 * (static_cast<double>(times[i]) + static_cast<double>(times[i - 1]));
  };
  for (size_t i = 0; i < steps; ++i) {
    const double moment = static_cast<double>(first_ns) + static_cast<double>(i) * kGridS * 1e9;
    while (at + 1 < times.size() && middle(at + 1) <= moment) ++at;
    if (at + 1 >= times.size()) break;
    const double span = middle(at + 1) - middle(at);
    const double share = span > 0 ? std::clamp((moment - middle(at)) / span, 0.0, 1.0) : 0;
    grid[i] = static_cast<float>((1 - share) * element.speeds[at] + share * element.speeds[at + 1]);
  }
  return grid;
}

/// Sums that make a correlation, over several windows.
struct Together {
  double n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;

  void add(const Grid& one, const Grid& other, int lag, size_t stride) {
    const size_t end = one.size() - kMaxLag;
    for (size_t i = kMaxLag; i < end; i += stride) {
      const double x = one[static_cast<size_t>(static_cast<int>(i) + lag)], y = other[i];
      n += 1;
      a += x;
      b += y;
      aa += x * x;
      bb += y * y;
      ab += x * y;
    }
  }
  [[nodiscard]] double correlation() const {
    const double va = aa - a * a / n, vb = bb - b * b / n;
    return va > 1e-12 && vb > 1e-12 ? std::abs(ab - a * b / n) / std::sqrt(va * vb) : 0;
  }
};

class ShiftPair {
 public:
  ShiftPair(const EntityMotion& one, const EntityMotion& other) : one_(one), other_(other) {
    const int64_t first = std::max(one_.times.front(), other_.times.front());
    const int64_t last = std::min(one_.times.back(), other_.times.back());
    const double steps = 1e-9 * static_cast<double>(std::max<int64_t>(0, last - first)) / kGridS;
    steps_ = std::min(kMaxWindowSteps, static_cast<size_t>(steps));
  }

  /// How much later `one` moves than `other`, and how sure that is.
  struct Shift {
    double seconds = 0;
    double correlation = 0;
    std::vector<double> curve{};  ///< The correlation at each lag.

    [[nodiscard]] double at(int lag) const { return curve[static_cast<size_t>(lag + kMaxLag)]; }
    [[nodiscard]] double gain() const { return correlation - at(0); }
  };
  [[nodiscard]] std::optional<Shift> find() const {
    if (steps_ < kMinWindowSteps) return std::nullopt;
    const std::vector<int64_t> windows = find_windows();
    if (windows.empty()) return std::nullopt;
    const auto [a, b] = choose_elements(windows);
    Shift best;
    std::vector<std::pair<Grid, Grid>> grids;
    for (const int64_t window : windows)
      grids.emplace_back(on_grid(one_, one_.elements[a], window, steps_),
                         on_grid(other_, other_.elements[b], window, steps_));
    for (int lag = -kMaxLag; lag <= kMaxLag; ++lag) {
      Together together;
      for (const auto& [mine, theirs] : grids) together.add(mine, theirs, lag, 1);
      const double found = together.correlation();
      best.curve.push_back(found);
      if (found <= best.correlation) continue;
      best.correlation = found;
      best.seconds = lag * kGridS;
    }
    return best;
  }

 private:
  static double motion_in(const EntityMotion& motion, int64_t first, int64_t last) {
    const auto begin = std::ranges::lower_bound(motion.times, first) - motion.times.begin();
    const auto end = std::ranges::lower_bound(motion.times, last) - motion.times.begin();
    double moving = 0;
    for (const EntityMotion::Element& element : motion.elements)
      moving += static_cast<double>(std::count_if(element.speeds.begin() + begin,
                                                  element.speeds.begin() + end,
                                                  [](float speed) { return speed != 0; }));
    return end > begin ? moving / static_cast<double>(end - begin) : 0;
  }

  /// The begins of the windows in which both move the most, in the order of time.
  [[nodiscard]] std::vector<int64_t> find_windows() const {
    const int64_t first = std::max(one_.times.front(), other_.times.front());
    const int64_t last = std::min(one_.times.back(), other_.times.back());
    const auto length = static_cast<int64_t>(static_cast<double>(steps_) * kGridS * 1e9);
    std::vector<std::pair<double, int64_t>> found;
    for (int64_t begin = first; begin + length <= last + length / 10; begin += length) {
      const double both =
          motion_in(one_, begin, begin + length) * motion_in(other_, begin, begin + length);
      if (both > 0) found.emplace_back(both, begin);
    }
    std::ranges::sort(found, std::greater());
    if (found.size() > kMaxWindows) found.resize(kMaxWindows);
    std::vector<int64_t> begins;
    for (const auto& [both, begin] : found) begins.push_back(begin);
    return begins;
  }

  /// The two elements that move together the most, at any shift.
  [[nodiscard]] std::pair<size_t, size_t> choose_elements(
      const std::vector<int64_t>& windows) const {
    const size_t count = std::min(windows.size(), kChosenWindows);
    const auto grids_of = [&](const EntityMotion& motion) {
      std::vector<std::vector<Grid>> grids;
      for (const EntityMotion::Element& element : motion.elements) {
        grids.emplace_back();
        for (size_t i = 0; i < count; ++i)
          grids.back().push_back(on_grid(motion, element, windows[i], steps_));
      }
      return grids;
    };
    const auto mine = grids_of(one_), theirs = grids_of(other_);
    std::pair<size_t, size_t> best{0, 0};
    double strongest = -1;
    for (size_t a = 0; a < mine.size(); ++a)
      for (size_t b = 0; b < theirs.size(); ++b)
        for (int lag = -kMaxLag; lag <= kMaxLag; lag += 5) {
          Together together;
          for (size_t i = 0; i < count; ++i) together.add(mine[a][i], theirs[b][i], lag, 4);
          const double found = together.correlation();
          if (found <= strongest) continue;
          strongest = found;
          best = {a, b};
        }
    return best;
  }

  const EntityMotion& one_;
  const EntityMotion& other_;
  size_t steps_ = 0;  ///< Of a window, on the grid.
};

/// Two entities that move together, the first of which links to the second.
struct MovingPair {
  MemoryId entity;
  MemoryId other;
  ShiftPair::Shift shift;

  [[nodiscard]] bool is_shifted() const {
    return std::abs(shift.seconds) >= kMinShiftS && shift.gain() >= kMinGain;
  }
};

/// How many other pairs of an entity say that it is late by `lag` rather than in time.
int votes_for(const MemoryId& id, int lag, const MovingPair& known,
              const std::vector<MovingPair>& pairs) {
  int votes = 0;
  for (const MovingPair& pair : pairs) {
    if (&pair == &known || (pair.entity != id && pair.other != id)) continue;
    const int seen = pair.entity == id ? lag : -lag;
    votes += pair.shift.at(seen) > pair.shift.at(0) ? 1 : -1;
  }
  return votes;
}

/// Of a pair that is shifted, the one is blamed that is shifted against others too; where none says
/// which, the one that links.
void blame(std::vector<MovingPair> pairs, const std::map<MemoryId, EntityReflection*>& entities,
           FindingList& findings) {
  while (true) {
    const auto worst = std::ranges::max_element(pairs, {}, [](const MovingPair& pair) {
      return pair.is_shifted() ? pair.shift.gain() : 0.0;
    });
    if (worst == pairs.end() || !worst->is_shifted()) return;
    const int lag = static_cast<int>(std::lround(worst->shift.seconds / kGridS));
    const bool is_first = votes_for(worst->entity, lag, *worst, pairs) >=
                          votes_for(worst->other, -lag, *worst, pairs);
    const MemoryId entity = is_first ? worst->entity : worst->other;
    const MemoryId other = is_first ? worst->other : worst->entity;
    const double shift_s = is_first ? worst->shift.seconds : -worst->shift.seconds;
    const auto known = entities.find(entity);
    const Time first = known == entities.end() ? Time{} : known->second->first;
    const Time last = known == entities.end() ? Time{} : known->second->last;
    findings.add({ReflectionKind::kTimeShift, Severity::kFault, entity, "", first, last, 1,
                  fmt::format("it moves {:.2g} s {} than {}", std::abs(shift_s),
                              shift_s > 0 ? "later" : "earlier", other.to_string()),
                  "the same motion at the same time"});
    std::erase_if(pairs, [&entity](const MovingPair& pair) {
      return pair.entity == entity || pair.other == entity;
    });
  }
}

}  // namespace

void look_at_shifts(const std::map<MemoryId, EntityMotion>& motions,
                    const std::set<std::pair<MemoryId, MemoryId>>& links,
                    const std::map<MemoryId, EntityReflection*>& entities,
                    std::vector<ShiftReflection>& shifts, FindingList& findings) {
  std::vector<MovingPair> pairs;
  for (const auto& [entity, other] : links) {
    const auto one = motions.find(entity), two = motions.find(other);
    if (one == motions.end() || two == motions.end() || entity == other) continue;
    if (one->second.elements.empty() || two->second.elements.empty()) continue;
    const auto found = ShiftPair(one->second, two->second).find();
    if (!found || found->correlation < kMinTogether) continue;
    for (const MemoryId* id : {&entity, &other})
      if (const auto known = entities.find(*id); known != entities.end())
        known->second->looked_at.insert(ReflectionKind::kTimeShift);
    pairs.push_back({entity, other, *found});
    shifts.push_back(
        {entity, other, pairs.back().is_shifted() ? found->seconds : 0.0, found->correlation});
  }
  blame(std::move(pairs), entities, findings);
}

}  // namespace engram::ltm
