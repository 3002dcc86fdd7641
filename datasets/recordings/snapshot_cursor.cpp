// SPDX-License-Identifier: Apache-2.0
#include "datasets/recordings/snapshot_cursor.h"

#include <algorithm>
#include <limits>
#include <set>

#include "ltm/recall/timeline_moments.h"

namespace engram::datasets {

namespace {

std::optional<Time> after(Time time) {
  if (to_ns(time) == std::numeric_limits<int64_t>::max()) return std::nullopt;
  return time_from_ns(to_ns(time) + 1);
}

}  // namespace

Result<SnapshotCursor> SnapshotCursor::create(ltm::Timeline& timeline,
                                              const std::vector<ltm::SnapshotQuery>& queries,
                                              const ltm::ListMoments& listed) {
  SnapshotCursor cursor(timeline);
  ltm::TimelineMoments moments(timeline);
  if (!listed) ENGRAM_RETURN_IF_ERROR(ltm::refuse_conditions(queries, "selection"));
  for (const ltm::SnapshotQuery& query : queries) {
    if (!query.conditions.empty()) {
      ENGRAM_ASSIGN_OR_RETURN(std::vector<Time> times, listed(query.conditions));
      ltm::ListedMoments met(std::move(times));
      ENGRAM_ASSIGN_OR_RETURN(const auto among, ltm::select_times(query.selector, met));
      if (among.snapshots) cursor.spans_.push_back({*among.snapshots, query.instances, met});
      continue;
    }
    ENGRAM_ASSIGN_OR_RETURN(const auto selection, ltm::select_times(query.selector, moments));
    if (selection.snapshots) cursor.spans_.push_back({*selection.snapshots, query.instances});
    if (selection.future)
      cursor.future_.push_back({{*selection.future, *selection.future}, query.instances});
  }
  std::ranges::stable_sort(cursor.future_, {}, [](const Span& span) { return span.times.first; });
  return cursor;
}

std::optional<Time> SnapshotCursor::next_start() const {
  const std::optional<Time> from = last_ ? after(*last_) : std::optional(Time::min());
  std::optional<Time> start;
  for (const Span& span : spans_) {
    if (!from || span.times.last < *from) continue;
    Time begin = std::max(span.times.first, *from);
    if (span.listed) {
      // A list cannot fail, and the span ends in one of its moments.
      ltm::ListedMoments listed = *span.listed;
      begin = **listed.at_or_after(begin);
    }
    if (!start || begin < *start) start = begin;
  }
  return start;
}

bool SnapshotCursor::has(const Span& span, Time time) {
  if (time < span.times.first || time > span.times.last) return false;
  if (!span.listed) return true;
  ltm::ListedMoments listed = *span.listed;
  return *listed.at_or_after(time) == time;
}

std::vector<int32_t> SnapshotCursor::instances_at(Time time) const {
  std::set<int32_t> indices;
  for (const std::vector<Span>* spans : {&spans_, &future_})
    for (const Span& span : *spans) {
      if (!has(span, time)) continue;
      if (span.instances.empty()) return {};
      indices.insert(span.instances.begin(), span.instances.end());
    }
  return {indices.begin(), indices.end()};
}

Result<std::optional<SnapshotCursor::Step>> SnapshotCursor::next() {
  if (const auto start = next_start()) {
    ENGRAM_ASSIGN_OR_RETURN(const auto entry, timeline_->at_or_after(*start));
    // The ends of spans are times of snapshots, so there is one.
    ENGRAM_CHECK(entry.has_value(), "a selection ends behind the last snapshot");
    last_ = entry->time;
    return std::optional(Step{*entry, false, instances_at(entry->time)});
  }
  for (const Span& span : future_) {
    if (last_ && span.times.first <= *last_) continue;
    last_ = span.times.first;
    return std::optional(Step{{span.times.first, {}, {}}, true, instances_at(span.times.first)});
  }
  return std::optional<Step>();
}

}  // namespace engram::datasets
