// SPDX-License-Identifier: Apache-2.0
#include "ltm/working/entity_history.h"

#include <algorithm>

#include "ltm/core/check.h"

namespace engram::ltm {

namespace {

/// Unsigned, because two times may lie 584 years apart. Unit: ns.
double distance(Time earlier, Time later) {
  return static_cast<double>(static_cast<uint64_t>(to_ns(later)) -
                             static_cast<uint64_t>(to_ns(earlier)));
}

}  // namespace

size_t EntityHistory::lower_bound(Time time) const {
  // New snapshots, and most that are searched, lie at the end.
  if (entries_.empty() || entries_.back().time < time) return entries_.size();
  if (time <= entries_.front().time) return 0;
  // The answer lies after `low` and not after `high`.
  size_t low = 0;
  size_t high = entries_.size() - 1;
  const Time first = entries_.front().time;
  const double share = distance(first, time) / distance(first, entries_.back().time);
  size_t probe = static_cast<size_t>(share * static_cast<double>(high));
  for (size_t step = 1; high - low > 1; step *= 2) {
    probe = std::clamp(probe, low + 1, high - 1);
    const bool is_before = entries_[probe].time < time;
    (is_before ? low : high) = probe;
    // Moves away from the guess, which is close at regular intervals, by growing steps; once they
    // reach too far, it bisects.
    const size_t next = is_before ? probe + step : probe - std::min(probe, step);
    probe = next > low && next < high ? next : low + (high - low) / 2;
  }
  return high;
}

std::optional<size_t> EntityHistory::find(Time time) const {
  const size_t index = lower_bound(time);
  if (index == entries_.size() || entries_[index].time != time) return std::nullopt;
  return index;
}

EntityHistory::Placed EntityHistory::put(Entry entry) {
  const size_t index = lower_bound(entry.time);
  Placed placed{index, {}, index < leaving_};
  if (index < entries_.size() && entries_[index].time == entry.time) {
    placed.replaced = std::exchange(entries_[index], std::move(entry));
    return placed;
  }
  entries_.insert(entries_.begin() + static_cast<std::ptrdiff_t>(index), std::move(entry));
  if (placed.is_leaving) ++leaving_;
  return placed;
}

EntityHistory::Entry& EntityHistory::choose_oldest() {
  ENGRAM_CHECK(staying() > 0, "none of {} snapshots stays", size());
  return entries_[leaving_++];
}

void EntityHistory::erase(size_t index) {
  ENGRAM_CHECK(index < size(), "snapshot {} of {}", index, size());
  if (index < leaving_) --leaving_;
  entries_.erase(entries_.begin() + static_cast<std::ptrdiff_t>(index));
}

std::vector<EntityHistory::Taken> EntityHistory::take(const TimeSet& times) {
  std::vector<Taken> taken;
  const size_t leaving = leaving_;
  size_t kept = 0;
  for (size_t i = 0; i < entries_.size(); ++i) {
    if (!times.contains(entries_[i].time)) {
      if (kept != i) entries_[kept] = std::move(entries_[i]);
      ++kept;
      continue;
    }
    const bool was_leaving = i < leaving;
    if (was_leaving) --leaving_;
    taken.push_back({std::move(entries_[i]), was_leaving});
  }
  entries_.erase(entries_.begin() + static_cast<std::ptrdiff_t>(kept), entries_.end());
  return taken;
}

}  // namespace engram::ltm
