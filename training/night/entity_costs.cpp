// SPDX-License-Identifier: Apache-2.0
#include "training/night/entity_costs.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace engram::training {

double EntityCosts::mean_encodes() const {
  if (encodes.empty()) return std::numeric_limits<double>::quiet_NaN();
  return std::accumulate(encodes.begin(), encodes.end(), 0.0) / static_cast<double>(encodes.size());
}

double EntityCosts::median_encodes() const {
  if (encodes.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::vector<int> sorted = encodes;
  std::ranges::sort(sorted);
  const size_t half = sorted.size() / 2;
  return sorted.size() % 2 == 1 ? sorted[half] : (sorted[half - 1] + sorted[half]) / 2.0;
}

}  // namespace engram::training
