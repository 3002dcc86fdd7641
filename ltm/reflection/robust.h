// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace engram::ltm {

/// The value below which the share `q` of the values lies; zero where there is none. NaN must not
/// be among them.
/// Complexity: O(n).
[[nodiscard]] double quantile(std::vector<double> values, double q);

/// Max `max_count` of the values, evenly spread, so that quantiles of millions stay cheap.
[[nodiscard]] std::vector<double> spread_sample(std::span<const double> values,
                                                size_t max_count = 8192);

/// Wilson's score interval of 95 % for a probability, after `successes` of `runs`.
[[nodiscard]] std::pair<double, double> wilson_interval(uint64_t successes, uint64_t runs);

}  // namespace engram::ltm
