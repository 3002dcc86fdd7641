// SPDX-License-Identifier: Apache-2.0
#include "ltm/context/meet_conditions.h"

#include <algorithm>

#include "ltm/context/meeting.h"

namespace engram::ltm {

namespace {

struct Interval {
  int64_t first = 0;
  int64_t last = 0;
};

/// When the spans of an entity went on, in order. Snapshots of one start are of one span; one
/// without an end goes on until the next one starts.
std::vector<Interval> intervals_of(const EntityContext::Spans& spans) {
  std::vector<Interval> intervals;
  for (size_t i = 0; i < spans.size(); ++i) intervals.push_back({spans.started[i], spans.ended[i]});
  std::ranges::sort(intervals, [](const Interval& a, const Interval& b) {
    return a.first != b.first ? a.first < b.first : a.last < b.last;
  });
  // Of one start the one that tells the end comes first.
  const auto same = [](const Interval& a, const Interval& b) { return a.first == b.first; };
  intervals.erase(std::unique(intervals.begin(), intervals.end(), same), intervals.end());
  for (size_t i = 0; i + 1 < intervals.size(); ++i)
    if (intervals[i].last == EntityContext::Spans::kOpen)
      intervals[i].last = intervals[i + 1].first - 1;
  return intervals;
}

Result<Met> meet_while(const Asked& asked, const where::While& during, const EntityContext& other) {
  Met met(asked.context.times.size(), 0);
  if (other.spans.size() == 0)
    return failed_precondition(
        "'{}' tells of nothing that starts and ends: needs times in 'started' and 'ended'",
        during.entity.to_string());
  // Spans may overlap: how far any of those that have started goes.
  const std::vector<Interval> intervals = intervals_of(other.spans);
  size_t next = 0;
  int64_t until = std::numeric_limits<int64_t>::min();
  for (size_t i = 0; i < met.size(); ++i) {
    const int64_t time = to_ns(asked.context.times[i]);
    for (; next < intervals.size() && intervals[next].first <= time; ++next)
      until = std::max(until, intervals[next].last);
    met[i] = time <= until && next > 0 ? 1 : 0;
  }
  return met;
}

Met meet_linked_to(const Asked& asked, const where::LinkedTo& linked) {
  const auto& links = asked.context.links;
  Met met(asked.context.times.size(), 0);
  const auto& targets = asked.context.targets;
  const auto found = std::ranges::find(targets, linked.id.entity());
  if (found == targets.end()) return met;
  const auto target = static_cast<uint32_t>(found - targets.begin());
  for (size_t i = 0; i < links.size(); ++i)
    if (links.target[i] == target &&
        (!linked.id.time() || links.time[i] == to_ns(*linked.id.time())) &&
        (!linked.id.index() || links.index[i] == *linked.id.index()))
      met[links.snapshot[i]] = 1;
  return met;
}

/// A link to an entity means the entity as it was then.
Met meet_links_from(const Asked& asked, const where::LinksFrom& linking,
                    const EntityContext& source) {
  const auto& links = source.links;
  const auto& times = asked.context.times;
  Met met(times.size(), 0);
  const auto found = std::ranges::find(source.targets, asked.id);
  if (found == source.targets.end()) return met;
  const auto target = static_cast<uint32_t>(found - source.targets.begin());
  for (size_t i = 0; i < links.size(); ++i) {
    const Time linked_at = source.times[links.snapshot[i]];
    if (links.target[i] != target || (linking.id.time() && linked_at != *linking.id.time()) ||
        (linking.id.index() && links.instance[i] != *linking.id.index()))
      continue;
    if (links.time[i] != EntityContext::Links::kNoTime) {
      if (const auto there = asked.context.find(time_from_ns(links.time[i]))) met[*there] = 1;
      continue;
    }
    const auto behind = std::ranges::upper_bound(times, linked_at);
    if (behind != times.begin()) met[static_cast<size_t>(behind - times.begin()) - 1] = 1;
  }
  return met;
}

/// Bytes may be anything's, so the compiler must know that these change nothing else.
void keep_where(const Met& met, bool is_negated, Met& all) {
  const uint8_t* const one = met.data();
  uint8_t* const kept = all.data();
  const auto flipped = static_cast<uint8_t>(is_negated);
  const size_t count = all.size();
  for (size_t i = 0; i < count; ++i) kept[i] = static_cast<uint8_t>(kept[i] & (one[i] ^ flipped));
}

/// The times of what is met. No branch depends on that, of which no processor knows the next.
std::vector<Time> times_where(const Met& met, const std::vector<Time>& times) {
  const auto count = static_cast<size_t>(std::ranges::count(met, 1));
  std::vector<Time> found(count + 1);  // One more, which is written where nothing is met.
  Time* next = found.data();
  for (size_t i = 0; i < met.size(); ++i) {
    *next = times[i];
    next += met[i];
  }
  found.pop_back();
  return found;
}

class Meeting {
 public:
  Meeting(const Asked& asked, KnownContexts& contexts) : asked_(asked), contexts_(contexts) {}

  Result<Met> operator()(const where::Near& near) { return meet_near(asked_, near); }
  Result<Met> operator()(const where::Within& within) {
    ENGRAM_ASSIGN_OR_RETURN(const auto other, context_of(within.entity));
    return meet_within(asked_, within, *other);
  }
  Result<Met> operator()(const where::InView& view) {
    ENGRAM_ASSIGN_OR_RETURN(const auto other, context_of(view.entity));
    return meet_view(asked_, view, *other, contexts_);
  }
  Result<Met> operator()(const where::While& during) {
    ENGRAM_ASSIGN_OR_RETURN(const auto other, context_of(during.entity));
    return meet_while(asked_, during, *other);
  }
  Result<Met> operator()(const where::LinkedTo& linked) { return meet_linked_to(asked_, linked); }
  Result<Met> operator()(const where::LinksFrom& linking) {
    ENGRAM_ASSIGN_OR_RETURN(const auto source, context_of(linking.id.entity()));
    return meet_links_from(asked_, linking, *source);
  }

 private:
  Result<std::shared_ptr<const EntityContext>> context_of(const MemoryId& entity) {
    ENGRAM_ASSIGN_OR_RETURN(auto context, contexts_.of(entity));
    if (context) return context;
    return not_found("there is no entity '{}'", entity.to_string());
  }

  const Asked& asked_;
  KnownContexts& contexts_;
};

}  // namespace

Result<std::vector<Time>> moments_meeting(const MemoryId& entity,
                                          std::span<const Condition> conditions, bool is_named,
                                          KnownContexts& contexts) {
  ENGRAM_ASSIGN_OR_RETURN(const auto context, contexts.of(entity));
  if (!context) return std::vector<Time>();
  const Asked asked{entity, *context, is_named};
  Meeting meeting(asked, contexts);
  Met all(context->times.size(), 1);
  for (const Condition& condition : conditions) {
    auto met = std::visit(meeting, condition.kind);
    if (!met.ok()) return met.status().with_context("'" + to_string(condition) + "'");
    keep_where(*met, condition.is_negated, all);
  }
  return times_where(all, context->times);
}

}  // namespace engram::ltm
