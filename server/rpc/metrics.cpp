// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/metrics.h"

#include <algorithm>
#include <cmath>

#include "ltm/core/check.h"

namespace engram::server {

Histogram::Histogram(std::vector<double> bounds)
    : bounds_(std::move(bounds)), counts_(bounds_.size() + 1) {
  for (size_t i = 0; i < bounds_.size(); ++i) {
    ENGRAM_CHECK(std::isfinite(bounds_[i]), "bound {} is {}", i, bounds_[i]);
    ENGRAM_CHECK(i == 0 || bounds_[i] > bounds_[i - 1], "bound {} is {} after {}", i, bounds_[i],
                 bounds_[i - 1]);
  }
}

void Histogram::observe(double number) {
  const bool is_number = std::isfinite(number);
  const size_t index =
      is_number ? static_cast<size_t>(std::ranges::lower_bound(bounds_, number) - bounds_.begin())
                : bounds_.size();
  counts_[index].fetch_add(1, std::memory_order_relaxed);
  if (is_number) sum_.fetch_add(number, std::memory_order_relaxed);
}

std::vector<uint64_t> Histogram::cumulative_counts() const {
  std::vector<uint64_t> counts;
  uint64_t count = 0;
  for (const auto& one : counts_) {
    count += one.load(std::memory_order_relaxed);
    counts.push_back(count);
  }
  return counts;
}

std::vector<double> latency_bounds() {
  return {1e-4, 2.5e-4, 5e-4, 1e-3, 2.5e-3, 5e-3, 1e-2, 2.5e-2,
          5e-2, 0.1,    0.25, 0.5,  1,      2.5,  5,    10};
}

}  // namespace engram::server
