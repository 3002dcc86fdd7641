// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "ltm/memory/result.h"

// Private to this room.

namespace engram::ltm {

/// What the next of such errors is at most, with kBoundProbability. Needs at least one.
[[nodiscard]] inline double bound_of(std::vector<double> errors) {
  std::ranges::sort(errors);
  const double rank = std::ceil(kBoundProbability * static_cast<double>(errors.size() + 1)) - 1;
  return errors[std::min(static_cast<size_t>(rank), errors.size() - 1)];
}

}  // namespace engram::ltm
