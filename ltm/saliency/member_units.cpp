// SPDX-License-Identifier: Apache-2.0
#include "ltm/saliency/member_units.h"

#include <algorithm>
#include <cmath>

namespace engram::ltm {

namespace {

constexpr double kStepsPerUnit = 4;
/// A unit is at least this share of the member's size: floats tell no smaller changes.
constexpr double kMinUnitShare = 1e-6;
constexpr double kMinUnit = 1e-9;

}  // namespace

void MemberUnits::add(const std::vector<ContentMember>& members, const std::vector<double>& before,
                      const std::vector<double>& after) {
  if (before.size() != after.size()) return;
  for (const ContentMember& member : members) {
    Sums& sums = members_[member.path];
    if (sums.mean.empty()) {
      sums.mean.assign(member.width, 0);
      sums.square.assign(member.width, 0);
    }
    if (sums.mean.size() != member.width) continue;  // Of another layout.
    sums.count += 1;
    double step = 0;
    for (size_t i = 0; i < member.width; ++i) {
      const double value = after[member.first + i];
      const double off = value - sums.mean[i];
      sums.mean[i] += off / sums.count;
      sums.square[i] += off * (value - sums.mean[i]);
      step += std::pow(value - before[member.first + i], 2);
    }
    sums.steps.push_back(std::sqrt(step / static_cast<double>(member.width)));
  }
}

void MemberUnits::finish() {
  for (auto& [path, sums] : members_) {
    if (sums.count == 0) continue;
    double variance = 0, size = 0;
    for (size_t i = 0; i < sums.mean.size(); ++i) {
      variance += sums.square[i] / sums.count;
      size = std::max(size, std::abs(sums.mean[i]));
    }
    const auto middle = sums.steps.begin() + static_cast<ptrdiff_t>(sums.steps.size() / 2);
    std::ranges::nth_element(sums.steps, middle);
    sums.unit =
        std::sqrt(variance / static_cast<double>(sums.mean.size())) + kStepsPerUnit * *middle;
    sums.unit = std::max({sums.unit, kMinUnitShare * size, kMinUnit});
  }
}

double MemberUnits::of(const std::string& path) const {
  const auto found = members_.find(path);
  return found == members_.end() || found->second.unit == 0 ? kMinUnit : found->second.unit;
}

}  // namespace engram::ltm
