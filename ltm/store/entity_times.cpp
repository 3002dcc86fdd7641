// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/entity_times.h"

#include <algorithm>
#include <iterator>

namespace engram::ltm {

namespace {

/// The part of `times` that lies between the first and the last of `others`, which are not empty.
auto range_of(std::vector<Time>& times, std::span<const Time> others) {
  return std::pair(std::ranges::lower_bound(times, others.front()),
                   std::ranges::upper_bound(times, others.back()));
}

/// Replaces a part of `times`.
void put(std::vector<Time>& times, std::vector<Time>::iterator begin,
         std::vector<Time>::iterator end, const std::vector<Time>& part) {
  const auto at = times.erase(begin, end);
  times.insert(at, part.begin(), part.end());
}

void unite(std::vector<Time>& times, std::span<const Time> more) {
  const auto [begin, end] = range_of(times, more);
  // Latents are of times that are known: nothing is moved for them.
  if (std::includes(begin, end, more.begin(), more.end())) return;
  std::vector<Time> united;
  united.reserve(static_cast<size_t>(end - begin) + more.size());
  std::set_union(begin, end, more.begin(), more.end(), std::back_inserter(united));
  put(times, begin, end, united);
}

void take_away(std::vector<Time>& times, std::span<const Time> gone) {
  const auto [begin, end] = range_of(times, gone);
  if (begin == end) return;
  std::vector<Time> left;
  std::set_difference(begin, end, gone.begin(), gone.end(), std::back_inserter(left));
  put(times, begin, end, left);
}

/// The first time from `begin` on that is not before `time`. It looks near `begin` first, because a
/// bin holds few of all times, and those far away are not in the processor's cache.
auto gallop(std::vector<Time>::const_iterator begin, std::vector<Time>::const_iterator end,
            Time time) {
  ptrdiff_t step = 1;
  while (step < end - begin && begin[step] < time) {
    begin += step;
    step *= 2;
  }
  return std::lower_bound(begin, begin + std::min(step, end - begin), time);
}

/// Calls `note(bin, count)` for each bin that has any of the times.
template <typename Note>
void count_times(const std::vector<Time>& times, const TimeBins& bins, const Note& note) {
  auto begin = std::ranges::lower_bound(times, bins.begin(0));
  for (size_t i = 0; i < bins.count() && begin != times.end(); ++i) {
    const auto end = gallop(begin, times.end(), bins.begin(i + 1));
    note(i, static_cast<uint32_t>(end - begin));
    begin = end;
  }
}

}  // namespace

Result<TimeBins> TimeBins::create(Time first, Time last, size_t count) {
  if (last <= first)
    return invalid_argument("a span from {} ns to {} ns: needs an end after its beginning",
                            to_ns(first), to_ns(last));
  if (count < 1 || count > kMaxCount)
    return invalid_argument("a span in {} parts: needs 1 to {}", count, kMaxCount);
  const uint64_t span = static_cast<uint64_t>(to_ns(last)) - static_cast<uint64_t>(to_ns(first));
  return TimeBins(first, span, count);
}

Time TimeBins::begin(size_t i) const {
  ENGRAM_CHECK(i <= count_, "there is no part {} of {}", i, count_);
  // Neither product exceeds 64 bits: the first is at most the span, the second below 2^32.
  const uint64_t after = span_ns_ / count_ * i + span_ns_ % count_ * i / count_;
  return time_from_ns(static_cast<int64_t>(static_cast<uint64_t>(to_ns(first_)) + after));
}

void EntityTimes::add(std::span<const Time> times, bool is_latent, bool is_augmented) {
  if (times.empty()) return;
  unite(all, times);
  if (is_latent) {
    unite(latent, times);
    take_away(augmented, times);
    return;
  }
  take_away(latent, times);
  if (is_augmented)
    unite(augmented, times);
  else
    take_away(augmented, times);
}

std::vector<FormCounts> EntityTimes::count_in(const TimeBins& bins) const {
  std::vector<FormCounts> counts(bins.count());
  count_times(all, bins, [&](size_t i, uint32_t count) { counts[i].recorded = count; });
  count_times(latent, bins, [&](size_t i, uint32_t count) {
    counts[i].latent = count;
    counts[i].recorded -= count;
  });
  count_times(augmented, bins, [&](size_t i, uint32_t count) {
    counts[i].augmented = count;
    counts[i].recorded -= count;
  });
  return counts;
}

}  // namespace engram::ltm
