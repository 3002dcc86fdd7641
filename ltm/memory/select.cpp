// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/select.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <tuple>

namespace engram::ltm {

namespace {

using Found = Result<std::optional<Time>>;

/// Returns `time` + `offset`, clamped to what 64 bits hold.
Time plus(Time time, Duration offset) {
  int64_t sum = 0;
  if (!__builtin_add_overflow(to_ns(time), offset.count(), &sum)) return time_from_ns(sum);
  return time_from_ns(offset < Duration(0) ? INT64_MIN : INT64_MAX);
}

/// The distance from `earlier` to `later`. Unsigned, because two times may lie 584 years apart.
uint64_t distance_ns(Time earlier, Time later) {
  return static_cast<uint64_t>(to_ns(later)) - static_cast<uint64_t>(to_ns(earlier));
}

/// The snapshot directly before or after `time`.
Found before(Moments& moments, Time time) {
  if (to_ns(time) == INT64_MIN) return std::optional<Time>();
  return moments.at_or_before(time_from_ns(to_ns(time) - 1));
}
Found after(Moments& moments, Time time) {
  if (to_ns(time) == INT64_MAX) return std::optional<Time>();
  return moments.at_or_after(time_from_ns(to_ns(time) + 1));
}

/// The snapshot at `index`, counted from the last. It steps back from the last snapshot, because
/// Moments do not know their number.
Found nth_from_end(Moments& moments, uint64_t index) {
  Found found = moments.last();
  for (; index > 0 && found.ok() && found.value(); --index) found = before(moments, **found);
  return found;
}

Selection span(std::optional<Time> first, std::optional<Time> last) {
  if (!first || !last || *last < *first) return {};
  return {Selection::Span{*first, *last}, {}};
}

/// Applies each kind of selector.
struct Selecting {
  Moments& moments;

  Result<Selection> operator()(select::All /*all*/) const {
    ENGRAM_ASSIGN_OR_RETURN(const auto first, moments.first());
    ENGRAM_ASSIGN_OR_RETURN(const auto last, moments.last());
    return span(first, last);
  }
  Result<Selection> operator()(select::Latest s) const {
    if (s.count <= 0) return Selection();
    return (*this)(select::IndexRange{-s.count, -1});
  }
  Result<Selection> operator()(select::At s) const {
    ENGRAM_ASSIGN_OR_RETURN(const auto last, moments.last());
    if (last && s.time > *last) return Selection{{}, s.time};
    ENGRAM_ASSIGN_OR_RETURN(const auto found, moments.at_or_after(s.time));
    return found == s.time ? span(s.time, s.time) : Selection();
  }
  Result<Selection> operator()(select::Ahead s) const {
    ENGRAM_ASSIGN_OR_RETURN(const auto last, moments.last());
    if (!last) return Selection();
    const Time time = plus(*last, s.offset);
    if (s.offset <= Duration(0)) return (*this)(select::At{time});
    return Selection{{}, time};
  }
  Result<Selection> operator()(select::Nearest s) const {
    ENGRAM_ASSIGN_OR_RETURN(const auto next, moments.at_or_after(s.time));
    ENGRAM_ASSIGN_OR_RETURN(const auto previous, moments.at_or_before(s.time));
    if (!next && !previous) return Selection();
    const uint64_t ahead = next ? distance_ns(s.time, *next) : UINT64_MAX;
    const uint64_t behind = previous ? distance_ns(*previous, s.time) : UINT64_MAX;
    // Of two snapshots at the same distance the earlier one is nearest.
    const auto best = previous && behind <= ahead ? previous : next;
    const bool is_close = std::min(ahead, behind) <= static_cast<uint64_t>(s.tolerance.count());
    return is_close || s.tolerance == Duration::max() ? span(best, best) : Selection();
  }
  Result<Selection> operator()(select::Before s) const {
    ENGRAM_ASSIGN_OR_RETURN(
        const auto found, s.is_inclusive ? moments.at_or_before(s.time) : before(moments, s.time));
    return span(found, found);
  }
  Result<Selection> operator()(select::After s) const {
    ENGRAM_ASSIGN_OR_RETURN(const auto found, after(moments, s.time));
    return span(found, found);
  }
  Result<Selection> operator()(select::TimeRange s) const {
    ENGRAM_ASSIGN_OR_RETURN(const auto first, moments.at_or_after(s.first));
    ENGRAM_ASSIGN_OR_RETURN(const auto last, moments.at_or_before(s.last));
    return span(first, last);
  }
  Result<Selection> operator()(select::LastDuration s) const {
    ENGRAM_ASSIGN_OR_RETURN(const auto last, moments.last());
    if (!last) return Selection();
    return (*this)(select::TimeRange{plus(*last, -s.duration), *last});
  }
  Result<Selection> operator()(select::IndexRange s) const {
    ENGRAM_ASSIGN_OR_RETURN(std::optional<Time> first, at_index(s.first));
    ENGRAM_ASSIGN_OR_RETURN(std::optional<Time> last, at_index(s.last));
    // Indices before the first or beyond the last snapshot mean the ends.
    if (!first && s.first < 0) {
      ENGRAM_ASSIGN_OR_RETURN(first, moments.first());
    }
    if (!last && s.last >= 0) {
      ENGRAM_ASSIGN_OR_RETURN(last, moments.last());
    }
    return span(first, last);
  }

  [[nodiscard]] Found at_index(int64_t index) const {
    return index >= 0 ? moments.nth(static_cast<uint64_t>(index))
                      : nth_from_end(moments, static_cast<uint64_t>(-(index + 1)));
  }
};

Status append(const Selection& selection, const std::vector<int32_t>& instances, Moments& moments,
              std::vector<SelectedSnapshot>& selected) {
  if (selection.snapshots) {
    std::optional<Time> time = selection.snapshots->first;
    while (time && *time <= selection.snapshots->last) {
      selected.push_back({*time, false, instances});
      ENGRAM_ASSIGN_OR_RETURN(time, after(moments, *time));
    }
  }
  if (selection.future) selected.push_back({*selection.future, true, instances});
  return {};
}

/// Adds the instances of `other`, which selects the same moment.
void unite(SelectedSnapshot& one, const SelectedSnapshot& other) {
  if (one.instances.empty() || other.instances.empty()) return one.instances.clear();
  std::vector<int32_t> united;
  std::ranges::set_union(one.instances, other.instances, std::back_inserter(united));
  one.instances = std::move(united);
}

/// The snapshots that meet the conditions of a query; nothing if it has none.
Result<std::optional<ListedMoments>> meeting(const SnapshotQuery& query,
                                             const ListMoments& listed) {
  if (query.conditions.empty()) return std::optional<ListedMoments>();
  if (!listed) return refuse_conditions({&query, 1}, "selection");
  ENGRAM_ASSIGN_OR_RETURN(std::vector<Time> times, listed(query.conditions));
  return std::optional(ListedMoments(std::move(times)));
}

/// What is to be predicted meets no condition.
Result<Selection> select_past(const SnapshotQuery& query, Moments& moments) {
  ENGRAM_ASSIGN_OR_RETURN(Selection selection, select_times(query.selector, moments));
  if (!query.conditions.empty()) selection.future.reset();
  return selection;
}

/// Sorts by time, and unites those of the same moment.
std::vector<SelectedSnapshot> in_order(std::vector<SelectedSnapshot> selected) {
  std::ranges::stable_sort(selected, {}, &SelectedSnapshot::time);
  std::vector<SelectedSnapshot> united;
  for (SelectedSnapshot& next : selected) {
    if (united.empty() || united.back().time < next.time)
      united.push_back(std::move(next));
    else
      unite(united.back(), next);
  }
  return united;
}

}  // namespace

Result<std::optional<Time>> ListedMoments::at_or_after(Time time) {
  const auto found = std::ranges::lower_bound(*times_, time);
  return found == times_->end() ? std::nullopt : std::optional(*found);
}

Result<std::optional<Time>> ListedMoments::at_or_before(Time time) {
  const auto found = std::ranges::upper_bound(*times_, time);
  return found == times_->begin() ? std::nullopt : std::optional(*std::prev(found));
}

Result<Selection> select_times(const Selector& selector, Moments& moments) {
  return std::visit(Selecting{moments}, selector);
}

Status refuse_conditions(std::span<const SnapshotQuery> queries, std::string_view who) {
  for (const SnapshotQuery& query : queries)
    if (!query.conditions.empty())
      return invalid_argument("{}: cannot select by '{}', which only queries answer", who,
                              to_string(query.conditions.front()));
  return {};
}

Result<std::vector<SelectedSnapshot>> select_snapshots(std::span<const SnapshotQuery> queries,
                                                       Moments& moments,
                                                       const ListMoments& listed) {
  std::vector<SelectedSnapshot> selected;
  for (const SnapshotQuery& query : queries) {
    ENGRAM_ASSIGN_OR_RETURN(auto among, meeting(query, listed));
    Moments& those = among ? static_cast<Moments&>(*among) : moments;
    ENGRAM_ASSIGN_OR_RETURN(const Selection selection, select_past(query, those));
    ENGRAM_RETURN_IF_ERROR(append(selection, query.instances, those, selected));
  }
  return in_order(std::move(selected));
}

Result<SelectedMoments> SelectedMoments::create(std::span<const SnapshotQuery> queries,
                                                Moments& moments, const ListMoments& listed) {
  SelectedMoments made;
  for (const SnapshotQuery& query : queries) {
    ENGRAM_ASSIGN_OR_RETURN(auto among, meeting(query, listed));
    Moments& those = among ? static_cast<Moments&>(*among) : moments;
    ENGRAM_ASSIGN_OR_RETURN(const Selection selection, select_past(query, those));
    if (selection.snapshots)
      made.parts_.push_back({*selection.snapshots, query.instances, std::move(among)});
    if (selection.future) made.future_.push_back({*selection.future, true, query.instances});
  }
  made.future_ = in_order(std::move(made.future_));
  return made;
}

/// Snapshots may have gone since they were selected.
Result<std::optional<Time>> SelectedMoments::next_of(const Part& part, std::optional<Time> time,
                                                     Moments& moments) {
  const bool has_begun = time && *time >= part.span.first;
  if (!part.listed)
    return has_begun ? ltm::after(moments, *time) : moments.at_or_after(part.span.first);
  ListedMoments listed = *part.listed;
  Found found = has_begun ? ltm::after(listed, *time) : listed.at_or_after(part.span.first);
  while (found.ok() && found.value()) {
    ENGRAM_ASSIGN_OR_RETURN(const auto there, moments.at_or_after(**found));
    if (there == *found) break;
    found = ltm::after(listed, **found);
  }
  return found;
}

Result<std::optional<SelectedSnapshot>> SelectedMoments::after(std::optional<Time> time,
                                                               Moments& moments) const {
  std::optional<SelectedSnapshot> next;
  for (const Part& part : parts_) {
    if (time && *time >= part.span.last) continue;
    ENGRAM_ASSIGN_OR_RETURN(const auto found, next_of(part, time, moments));
    if (!found || *found > part.span.last || (next && *found > next->time)) continue;
    SelectedSnapshot one{*found, false, part.instances};
    if (next && next->time == *found)
      unite(*next, one);
    else
      next = std::move(one);
  }
  return next;
}

}  // namespace engram::ltm
