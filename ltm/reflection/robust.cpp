// SPDX-License-Identifier: Apache-2.0
#include "ltm/reflection/robust.h"

#include <algorithm>
#include <cmath>

namespace engram::ltm {

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0;
  const auto at = static_cast<ptrdiff_t>(q * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<size_t>(at)];
}

std::vector<double> spread_sample(std::span<const double> values, size_t max_count) {
  if (values.size() <= max_count) return {values.begin(), values.end()};
  std::vector<double> sample;
  sample.reserve(max_count);
  const double step = static_cast<double>(values.size()) / static_cast<double>(max_count);
  for (size_t i = 0; i < max_count; ++i)
    sample.push_back(values[static_cast<size_t>(static_cast<double>(i) * step)]);
  return sample;
}

std::pair<double, double> wilson_interval(uint64_t successes, uint64_t runs) {
  if (runs == 0) return {0.0, 1.0};
  constexpr double kNormal = 1.959963984540054;  // The quantile 0.975 of the normal distribution.
  const auto n = static_cast<double>(runs);
  const double share = static_cast<double>(successes) / n;
  const double middle = share + kNormal * kNormal / (2 * n);
  const double half =
      kNormal * std::sqrt(share * (1 - share) / n + kNormal * kNormal / (4 * n * n));
  const double scale = 1 + kNormal * kNormal / n;
  return {std::max(0.0, (middle - half) / scale), std::min(1.0, (middle + half) / scale)};
}

}  // namespace engram::ltm
