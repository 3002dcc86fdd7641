// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "ltm/memory/result.h"

// Private to this room.

namespace engram::ltm {

/// A bound that the next error of this kind stays within, with kBoundProbability. Needs at least
/// one error.
[[nodiscard]] inline double bound_of(std::vector<double> errors) {
  const double rank = std::ceil(kBoundProbability * static_cast<double>(errors.size() + 1)) - 1;
  const size_t place = std::min(static_cast<size_t>(rank), errors.size() - 1);
  const auto bound = errors.begin() + static_cast<std::ptrdiff_t>(place);
  std::ranges::nth_element(errors, bound);
  return *bound;
}

}  // namespace engram::ltm
