// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <vector>

namespace engram::ltm {

/// Sorts entries from journals by `time` and keeps only the last appended one of each time. Two
/// entries have the same time if one is an update, or if its append was repeated after a failed
/// sync.
template <typename T>
void keep_last_of_each_time(std::vector<T>& appended) {
  std::ranges::stable_sort(appended, {}, &T::time);
  // unique keeps the first of a run: walk from the back to keep the last.
  const auto kept = std::unique(appended.rbegin(), appended.rend(),
                                [](const T& a, const T& b) { return a.time == b.time; });
  appended.erase(appended.begin(), kept.base());
}

}  // namespace engram::ltm
