// SPDX-License-Identifier: Apache-2.0
#include "ltm/saliency/novelty_meter.h"

#include <algorithm>
#include <limits>

namespace engram::ltm {

namespace {

constexpr double kRadiusGrowth = 1.5;

}  // namespace

double NoveltyMeter::next(const ContentSeries& series, size_t at) {
  double nearest = examples_.empty() ? 1 : std::numeric_limits<double>::infinity();
  const auto row = series.row(at);
  for (const auto& example : examples_) {
    nearest = std::min(nearest, distance_of(members_, row, example));
    if (nearest == 0) break;
  }
  learn(row, nearest);
  double rarity = 0;
  const uint64_t facts = series.facts[at];
  if (const auto found = texts_.find(facts); found != texts_.end())
    rarity = 1 / static_cast<double>(++found->second);
  else if (facts != 0 && texts_.size() < kMaxTexts)
    rarity = static_cast<double>(texts_[facts] = 1);
  return std::min(1.0, std::max(nearest, rarity));
}

void NoveltyMeter::learn(std::span<const float> row, double distance) {
  if (!examples_.empty() && distance <= radius_) return;
  examples_.emplace_back(row.begin(), row.end());
  while (examples_.size() > kMaxExamples) thin();
}

void NoveltyMeter::thin() {
  radius_ *= kRadiusGrowth;
  std::vector<std::vector<float>> kept;
  for (auto& example : examples_) {
    const bool is_near = std::ranges::any_of(
        kept, [&](const auto& other) { return distance_of(members_, example, other) <= radius_; });
    if (!is_near) kept.push_back(std::move(example));
  }
  examples_ = std::move(kept);
}

}  // namespace engram::ltm
