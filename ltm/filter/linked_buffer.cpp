// SPDX-License-Identifier: Apache-2.0
#include "ltm/filter/linked_buffer.h"

#include "ltm/filter/saturated_time.h"
#include "ltm/filter/window_buffer.h"

namespace engram::ltm {

namespace {

/// Links to snapshots that the filters kept are wanted in vain, and links from outside may name any
/// time, so that their number is bounded.
constexpr size_t kMaxWanted = 4096;

}  // namespace

std::optional<LinkedBuffer::Dropped> LinkedBuffer::add(Dropped dropped) {
  const Time time = dropped.candidate.snapshot.time;
  if (wanted_.erase(time) > 0) return dropped;
  held_bytes_ += dropped.candidate.raw_bytes;
  held_.insert_or_assign(time, std::move(dropped));
  return {};
}

std::optional<LinkedBuffer::Dropped> LinkedBuffer::want(Time time) {
  if (const auto found = held_.find(time); found != held_.end()) return take(found);
  wanted_.insert(time);
  if (wanted_.size() > kMaxWanted) wanted_.erase(wanted_.begin());
  return {};
}

LinkedBuffer::Dropped LinkedBuffer::take(Held::iterator at) {
  Dropped dropped = std::move(at->second);
  held_bytes_ -= dropped.candidate.raw_bytes;
  held_.erase(at);
  return dropped;
}

std::vector<LinkedBuffer::Dropped> LinkedBuffer::give_up(Time newest) {
  std::vector<Dropped> given_up;
  const Time oldest = saturated_add(newest, -options_.keeps);
  const auto is_too_much = [this] {
    return held_bytes_ + held_.size() * WindowBuffer::kHeldOverheadBytes > options_.max_held_bytes;
  };
  while (!held_.empty() && (held_.begin()->first < oldest || is_too_much()))
    given_up.push_back(take(held_.begin()));
  wanted_.erase(wanted_.begin(), wanted_.lower_bound(oldest));
  return given_up;
}

std::vector<LinkedBuffer::Dropped> LinkedBuffer::give_up_all() {
  std::vector<Dropped> given_up;
  while (!held_.empty()) given_up.push_back(take(held_.begin()));
  wanted_.clear();
  return given_up;
}

std::vector<LinkedBuffer::Dropped> LinkedBuffer::give_up(const TimeSet& times) {
  std::vector<Dropped> given_up;
  for (auto at = held_.begin(); at != held_.end();) {
    const auto here = at++;
    if (times.contains(here->first)) given_up.push_back(take(here));
  }
  return given_up;
}

void LinkedBuffer::add_held_times(TimeSet& times) const {
  for (const auto& [time, dropped] : held_) times.insert(time);
}

HeldSnapshots LinkedBuffer::held_of(size_t stage) const {
  HeldSnapshots held;
  for (const auto& [time, dropped] : held_) {
    if (dropped.stage != stage) continue;
    ++held.snapshots;
    held.bytes += dropped.candidate.raw_bytes;
  }
  return held;
}

}  // namespace engram::ltm
