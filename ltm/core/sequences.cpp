// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/sequences.h"

#include <algorithm>

namespace engram {

namespace {

constexpr double kUsualShare = 0.9;
constexpr int kUnusual = 4;  ///< Times a usual step.

/// The step that this share of all steps does not exceed; zero for fewer than two times.
Duration step_quantile(std::span<const Time> times, double share) {
  if (times.size() < 2) return {};
  std::vector<Duration> steps;
  for (size_t i = 1; i < times.size(); ++i) steps.push_back(times[i] - times[i - 1]);
  const auto at =
      steps.begin() + static_cast<std::ptrdiff_t>(static_cast<double>(steps.size() - 1) * share);
  std::nth_element(steps.begin(), at, steps.end());
  return *at;
}

/// Cuts at gaps that are longer, and where time decreases.
std::vector<Sequence> cut_at(std::span<const Time> times, Duration longest) {
  if (times.empty()) return {};
  std::vector<Sequence> sequences{{0, 1}};
  for (size_t i = 1; i < times.size(); ++i) {
    const Duration gap = times[i] - times[i - 1];
    if (gap > longest || gap < Duration::zero()) sequences.push_back({i, i});
    sequences.back().end = i + 1;
  }
  return sequences;
}

}  // namespace

Duration median_step(std::span<const Time> times) {
  return step_quantile(times, 0.5);
}

std::vector<Sequence> cut_sequences(std::span<const Time> times) {
  return cut_at(times, median_step(times) / 2 * 3);
}

std::vector<Sequence> cut_recordings(std::span<const Time> times) {
  const Duration usual = step_quantile(times, kUsualShare);
  Duration longest = std::chrono::milliseconds(1);
  // Times may be centuries apart: twice the limit must still be a duration.
  while (longest / kUnusual < usual && longest <= Duration::max() / 2) longest *= 2;
  return cut_at(times, longest);
}

std::vector<std::vector<size_t>> interleaved(std::span<const Time> times, const Sequence& recording,
                                             Duration every) {
  const auto own = times.subspan(recording.first, recording.size());
  const Duration min = every - median_step(own) / 2;
  std::vector<std::vector<size_t>> runs;
  for (size_t start = 0; start < own.size(); ++start) {
    if (start > 0 && own[start] - own[0] >= min) break;
    std::vector<size_t>& run = runs.emplace_back();
    for (size_t i = start; i < own.size(); ++i)
      if (run.empty() || own[i] - times[run.back()] >= min) run.push_back(recording.first + i);
  }
  return runs;
}

}  // namespace engram
