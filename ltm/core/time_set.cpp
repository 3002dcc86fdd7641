// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/time_set.h"

#include <algorithm>
#include <iterator>

namespace engram {

TimeSet::TimeSet(std::initializer_list<Time> times) : TimeSet(std::vector<Time>(times)) {}

TimeSet::TimeSet(std::vector<Time> times) : times_(std::move(times)) {
  std::ranges::sort(times_);
  times_.erase(std::unique(times_.begin(), times_.end()), times_.end());
}

bool TimeSet::insert(Time time) {
  const auto place = times_.empty() || times_.back() < time
                         ? times_.end()
                         : std::ranges::lower_bound(times_, time);
  if (place != times_.end() && *place == time) return false;
  times_.insert(place, time);
  return true;
}

void TimeSet::insert_all(const TimeSet& others) {
  std::vector<Time> both;
  both.reserve(times_.size() + others.times_.size());
  std::ranges::set_union(times_, others.times_, std::back_inserter(both));
  times_ = std::move(both);
}

bool TimeSet::contains(Time time) const {
  return std::ranges::binary_search(times_, time);
}

bool TimeSet::has_any_in(Time first, Time last) const {
  const auto found = std::ranges::lower_bound(times_, first);
  return found != times_.end() && *found <= last;
}

}  // namespace engram
