// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ltm/saliency/change_meter.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm {

/// A series of one number, five a second.
inline ContentSeries drawn_series(const std::vector<float>& numbers) {
  ContentSeries series;
  series.members = {{"x", 0, 1}};
  for (size_t i = 0; i < numbers.size(); ++i) {
    series.times.push_back(example_time(static_cast<int64_t>(i)));
    series.numbers.push_back(numbers[i]);
    series.facts.push_back(1);
    series.follows.push_back(i > 0 ? 1 : 0);
  }
  return series;
}

}  // namespace engram::ltm
