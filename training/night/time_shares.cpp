// SPDX-License-Identifier: Apache-2.0
#include "training/night/time_shares.h"

#include <algorithm>

#include "ltm/core/check.h"

namespace engram::training {

TimeShare first_share(std::span<const TimeNeed> rest, double left) {
  ENGRAM_CHECK(!rest.empty(), "no entity to give time to");
  left = std::max(left, 0.0);
  double encoding = 0, weights = 0;
  for (const TimeNeed& need : rest) {
    encoding += need.encoding;
    weights += need.weight;
  }
  const TimeNeed& first = rest.front();
  if (encoding > left)
    return {0, std::min(first.encoding, left / static_cast<double>(rest.size())), true};
  const double training = weights > 0 ? (left - encoding) * first.weight / weights : 0;
  return {training, first.encoding, false};
}

}  // namespace engram::training
