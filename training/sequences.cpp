// SPDX-License-Identifier: Apache-2.0
#include "training/sequences.h"

#include <algorithm>

namespace engram::training {

Duration median_step(std::span<const Time> times) {
  if (times.size() < 2) return {};
  std::vector<Duration> steps;
  for (size_t i = 1; i < times.size(); ++i) steps.push_back(times[i] - times[i - 1]);
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>((steps.size() - 1) / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

std::vector<Sequence> cut_sequences(std::span<const Time> times) {
  if (times.empty()) return {};
  const Duration longest = median_step(times) / 2 * 3;
  std::vector<Sequence> sequences{{0, 1}};
  for (size_t i = 1; i < times.size(); ++i) {
    if (times[i] - times[i - 1] > longest) sequences.push_back({i, i});
    sequences.back().end = i + 1;
  }
  return sequences;
}

}  // namespace engram::training
