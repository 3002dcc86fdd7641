// SPDX-License-Identifier: Apache-2.0
#include "ltm/recall/select.h"

#include <algorithm>
#include <iterator>
#include <tuple>

namespace engram::ltm {

namespace {

/// The end of what 64 bits hold where `time` + `offset` lies beyond it.
Time plus(Time time, Duration offset) {
  int64_t sum = 0;
  if (!__builtin_add_overflow(to_ns(time), offset.count(), &sum)) return time_from_ns(sum);
  return time_from_ns(offset < Duration(0) ? INT64_MIN : INT64_MAX);
}

/// Between `earlier` and `later`. Unsigned: two times may lie 584 years apart.
uint64_t distance_ns(Time earlier, Time later) {
  return static_cast<uint64_t>(to_ns(later)) - static_cast<uint64_t>(to_ns(earlier));
}

/// Applies each kind of selector to the same times.
struct Selecting {
  std::span<const Time> times;

  [[nodiscard]] size_t size() const { return times.size(); }
  [[nodiscard]] size_t lower(Time time) const {
    return static_cast<size_t>(std::ranges::lower_bound(times, time) - times.begin());
  }
  [[nodiscard]] size_t upper(Time time) const {
    return static_cast<size_t>(std::ranges::upper_bound(times, time) - times.begin());
  }
  [[nodiscard]] static Selection range(size_t first, size_t end) {
    return {first, end > first ? end - first : 0, {}};
  }

  Selection operator()(select::All) const { return range(0, size()); }
  Selection operator()(select::Latest s) const {
    const size_t count = std::min(size(), static_cast<size_t>(std::max<int64_t>(s.count, 0)));
    return range(size() - count, size());
  }
  Selection operator()(select::At s) const {
    if (!times.empty() && s.time > times.back()) return {0, 0, s.time};
    return range(lower(s.time), upper(s.time));
  }
  Selection operator()(select::Ahead s) const {
    if (times.empty()) return {};
    if (s.offset <= Duration(0)) return (*this)(select::At{plus(times.back(), s.offset)});
    return {0, 0, plus(times.back(), s.offset)};
  }
  Selection operator()(select::Nearest s) const {
    if (times.empty()) return {};
    const size_t next = lower(s.time);
    const uint64_t ahead = next < size() ? distance_ns(s.time, times[next]) : UINT64_MAX;
    const uint64_t behind = next > 0 ? distance_ns(times[next - 1], s.time) : UINT64_MAX;
    // Of two equally close the earlier.
    const size_t best = behind <= ahead ? next - 1 : next;
    const bool is_close = std::min(ahead, behind) <= static_cast<uint64_t>(s.tolerance.count());
    return is_close || s.tolerance == Duration::max() ? range(best, best + 1) : Selection{};
  }
  Selection operator()(select::Before s) const {
    const size_t end = s.is_inclusive ? upper(s.time) : lower(s.time);
    return end == 0 ? Selection{} : range(end - 1, end);
  }
  Selection operator()(select::After s) const {
    const size_t first = upper(s.time);
    return first == size() ? Selection{} : range(first, first + 1);
  }
  Selection operator()(select::TimeRange s) const { return range(lower(s.first), upper(s.last)); }
  Selection operator()(select::LastDuration s) const {
    return times.empty() ? Selection{} : range(lower(plus(times.back(), -s.duration)), size());
  }
  Selection operator()(select::IndexRange s) const {
    const auto count = static_cast<int64_t>(size());
    const auto from_end = [count](int64_t index) { return index < 0 ? index + count : index; };
    const int64_t first = std::max<int64_t>(from_end(s.first), 0);
    const int64_t last = std::min(from_end(s.last), count - 1);
    if (last < first) return {};
    return range(static_cast<size_t>(first), static_cast<size_t>(last) + 1);
  }
};

void append(const Selection& selection, const std::vector<int32_t>& instances,
            std::vector<SelectedSnapshot>& selected) {
  for (size_t i = selection.first; i < selection.first + selection.count; ++i)
    selected.push_back({i, {}, instances});
  if (selection.future) selected.push_back({SIZE_MAX, selection.future, instances});
}

bool is_earlier(const SelectedSnapshot& a, const SelectedSnapshot& b) {
  return std::tie(a.index, a.future) < std::tie(b.index, b.future);
}

/// Adds the instances of `other`, which asks for the same moment.
void unite(SelectedSnapshot& one, const SelectedSnapshot& other) {
  if (one.instances.empty() || other.instances.empty()) return one.instances.clear();
  std::vector<int32_t> united;
  std::ranges::set_union(one.instances, other.instances, std::back_inserter(united));
  one.instances = std::move(united);
}

}  // namespace

Selection select_times(const Selector& selector, std::span<const Time> times) {
  return std::visit(Selecting{times}, selector);
}

std::vector<SelectedSnapshot> select_snapshots(std::span<const SnapshotQuery> queries,
                                               std::span<const Time> times) {
  std::vector<SelectedSnapshot> selected;
  for (const SnapshotQuery& query : queries)
    append(select_times(query.selector, times), query.instances, selected);
  if (queries.size() < 2) return selected;
  std::ranges::stable_sort(selected, is_earlier);
  std::vector<SelectedSnapshot> united;
  for (SelectedSnapshot& next : selected) {
    if (united.empty() || is_earlier(united.back(), next))
      united.push_back(std::move(next));
    else
      unite(united.back(), next);
  }
  return united;
}

}  // namespace engram::ltm
