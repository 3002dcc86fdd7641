// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <vector>

namespace engram::ltm {

/// Orders what stands in journals by its `time`; of equal times the last counts: it is an update,
/// or an append whose sync failed and that was tried again.
template <typename T>
void keep_last_of_each_time(std::vector<T>& appended) {
  std::ranges::stable_sort(appended, {}, &T::time);
  // unique keeps the first of a run: walk from the back to keep the last.
  const auto kept = std::unique(appended.rbegin(), appended.rend(),
                                [](const T& a, const T& b) { return a.time == b.time; });
  appended.erase(appended.begin(), kept.base());
}

}  // namespace engram::ltm
