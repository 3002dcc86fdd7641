// SPDX-License-Identifier: Apache-2.0
#include "speech/noticing/hand_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace engram::speech {

namespace {

constexpr double kMinShareOfRange = 0.25;
constexpr double kMinNoises = 8;
/// A hand whose range is less than that of the largest number it has only trembles.
constexpr double kMinShareOfSize = 0.05;
constexpr size_t kMinSamples = 10;
/// A hand that holds something holds it so long.
constexpr Duration kMinHold = std::chrono::seconds(1);
/// And so long where it closed last of all: hands close when they go back to rest, too.
constexpr Duration kMinLastHold = std::chrono::seconds(3);

double quantile(std::vector<double> numbers, double share) {
  const auto at = static_cast<size_t>(share * static_cast<double>(numbers.size() - 1));
  std::nth_element(numbers.begin(), numbers.begin() + static_cast<ptrdiff_t>(at), numbers.end());
  return numbers[at];
}

/// Cuts off both ends of a swing between two turns what is less than a tenth of its way.
HandSwing without_creeping(std::span<const HandSample> samples, size_t from, size_t to) {
  HandSwing swing{from, from, to, samples[from].open, samples[to].open};
  const auto share = [&](size_t at) {
    return (samples[at].open - swing.before) / (swing.after - swing.before);
  };
  while (swing.began < to && share(swing.began + 1) < 0.1) ++swing.began;
  swing.middle = swing.began;
  while (swing.middle < to && share(swing.middle) < 0.5) ++swing.middle;
  swing.ended = swing.middle;
  while (swing.ended < to && share(swing.ended) < 0.9) ++swing.ended;
  return swing;
}

}  // namespace

double min_swing(std::span<const HandSample> samples) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  if (samples.size() < kMinSamples) return kNever;
  std::vector<double> open;
  std::vector<double> steps;
  for (size_t i = 0; i < samples.size(); ++i) {
    open.push_back(samples[i].open);
    if (i > 0) steps.push_back(std::abs(samples[i].open - samples[i - 1].open));
  }
  const double lowest = quantile(open, 0.02);
  const double highest = quantile(open, 0.98);
  const double range = highest - lowest;
  if (range < kMinShareOfSize * std::max(std::abs(lowest), std::abs(highest))) return kNever;
  // Most of the time a hand stands still, so the median step is noise.
  const double noise = quantile(steps, 0.5);
  const double min_change = std::max(kMinShareOfRange * range, kMinNoises * noise);
  return min_change > 0 ? min_change : kNever;
}

std::vector<HandSwing> hand_swings(std::span<const HandSample> samples, double min_change) {
  std::vector<HandSwing> swings;
  if (samples.empty() || !(min_change > 0)) return swings;
  // The turn before, and the furthest sample since: a swing is over once it has come back from
  // there by as much as a swing needs.
  size_t lowest = 0;
  size_t highest = 0;
  size_t turn = 0;
  size_t furthest = 0;
  int direction = 0;  // 1: opens; -1: closes; 0: not known yet.
  for (size_t i = 1; i < samples.size(); ++i) {
    const double open = samples[i].open;
    if (direction == 0) {
      if (open < samples[lowest].open) lowest = i;
      if (open > samples[highest].open) highest = i;
      if (samples[highest].open - samples[lowest].open < min_change) continue;
      direction = highest > lowest ? 1 : -1;
      turn = std::min(lowest, highest);
      furthest = std::max(lowest, highest);
      continue;
    }
    const double beyond = direction * (open - samples[furthest].open);
    if (beyond > 0) furthest = i;
    if (-beyond < min_change) continue;
    swings.push_back(without_creeping(samples, turn, furthest));
    turn = furthest;
    furthest = i;
    direction = -direction;
  }
  if (direction != 0) swings.push_back(without_creeping(samples, turn, furthest));
  return swings;
}

std::vector<Grasp> grasps_in(std::span<const HandSample> samples, double min_change) {
  const std::vector<HandSwing> swings = hand_swings(samples, min_change);
  std::vector<Grasp> grasps;
  for (size_t i = 0; i < swings.size(); ++i) {
    if (!swings[i].closes()) continue;
    Grasp grasp{swings[i], {}, i + 1 < swings.size()};
    if (grasp.has_let_go) grasp.open = swings[i + 1];
    const Time held_until =
        grasp.has_let_go ? samples[grasp.open.middle].time : samples.back().time;
    const Duration min_hold = grasp.has_let_go || grasps.empty() ? kMinHold : kMinLastHold;
    if (held_until - samples[grasp.close.ended].time >= min_hold) grasps.push_back(grasp);
  }
  return grasps;
}

}  // namespace engram::speech
