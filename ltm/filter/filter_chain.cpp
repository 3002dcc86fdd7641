// SPDX-License-Identifier: Apache-2.0
#include "ltm/filter/filter_chain.h"

#include <algorithm>

namespace engram::ltm {

uint64_t FilterCounters::dropped() const {
  uint64_t total = 0;
  for (const auto& [reason, count] : dropped_by) total += count;
  return total;
}

Result<FilterChain> FilterChain::create(std::vector<FilterOptions> filters) {
  FilterChain chain(std::move(filters));
  for (const FilterOptions& options : chain.options_) {
    ENGRAM_ASSIGN_OR_RETURN(auto filter, make_filter(options));
    Stage stage{std::move(filter), {}};
    stage.counters.filter = stage.filter->name();
    chain.stages_.push_back(std::move(stage));
  }
  return chain;
}

bool FilterChain::is_late(Time time) {
  if (!newest_ || time > *newest_) {
    late_run_ = 0;
    return false;
  }
  // A few late candidates are out of order. Only a run in order can be a clock that was set back.
  late_run_ = newest_late_ && late_run_ > 0 && time > *newest_late_ ? late_run_ + 1 : 1;
  newest_late_ = time;
  return true;
}

void FilterChain::begin_anew(Output& output) {
  // Filters remember times after the new ones, so they would drop all until the old time is
  // reached again. Only new filters forget it.
  flush(output);
  for (size_t i = 0; i < stages_.size(); ++i) replace_filter(i);
  late_run_ = 0;
}

void FilterChain::replace_filter(size_t stage) {
  auto filter = make_filter(options_[stage]);
  ENGRAM_CHECK(filter.ok(), "{}", filter.status().message());
  stages_[stage].filter = *std::move(filter);
}

void FilterChain::add_held_times(TimeSet& times) const {
  for (const Stage& stage : stages_) stage.filter->add_held_times(times);
}

void FilterChain::forget(const TimeSet& times, Output& output) {
  for (size_t i = 0; i < stages_.size(); ++i) {
    FilterDecisions decisions;
    if (!stages_[i].filter->forget(times, decisions)) replace_filter(i);
    settle(i, std::move(decisions), output);
  }
}

void FilterChain::offer(Candidate candidate, Output& output) {
  const Time time = candidate.snapshot.time;
  if (is_late(time)) {
    if (late_run_ < kLateOfNewClock) {
      ++late_;
      output.kept.push_back(std::move(candidate));
      return;
    }
    begin_anew(output);
  }
  newest_ = time;
  pass(0, std::move(candidate), output);
}

bool FilterChain::drop_at(Time time, uint64_t raw_bytes, Output& output) {
  if (stages_.empty() || (newest_ && time <= *newest_)) return false;
  const auto reason = stages_[0].filter->drops_at(time);
  if (!reason) return false;
  late_run_ = 0;
  newest_ = time;
  ++stages_[0].counters.offered;
  stages_[0].counters.offered_bytes += raw_bytes;
  FilterDecisions decisions;
  decisions.drop(*reason, raw_bytes);
  settle(0, std::move(decisions), output);
  return true;
}

void FilterChain::pass(size_t stage, Candidate candidate, Output& output) {
  if (stage == stages_.size()) {
    output.kept.push_back(std::move(candidate));
    return;
  }
  FilterCounters& counters = stages_[stage].counters;
  ++counters.offered;
  counters.offered_bytes += candidate.raw_bytes;
  FilterDecisions decisions;
  stages_[stage].filter->offer(std::move(candidate), decisions);
  settle(stage, std::move(decisions), output);
}

void FilterChain::settle(size_t stage, FilterDecisions decisions, Output& output) {
  FilterCounters& counters = stages_[stage].counters;
  for (const FilterDecisions::Drop& drop : decisions.dropped) {
    const auto known = counters.dropped_by.find(drop.reason);
    if (known == counters.dropped_by.end())
      counters.dropped_by.emplace(drop.reason, 1);
    else
      ++known->second;
    counters.dropped_bytes += drop.bytes;
    ++output.dropped;
    output.dropped_bytes += drop.bytes;
  }
  counters.kept += decisions.kept.size();
  for (Candidate& kept : decisions.kept) pass(stage + 1, std::move(kept), output);
}

void FilterChain::flush(Output& output) {
  // In the order of the chain: what one filter releases, the next ones still decide on.
  for (size_t i = 0; i < stages_.size(); ++i) {
    FilterDecisions decisions;
    stages_[i].filter->flush(decisions);
    settle(i, std::move(decisions), output);
  }
}

void FilterChain::notice(const Snapshot& snapshot, const std::optional<idf::Type>& type,
                         Output& output) {
  for (size_t i = 0; i < stages_.size(); ++i) {
    FilterDecisions decisions;
    stages_[i].filter->notice(snapshot, type, decisions);
    settle(i, std::move(decisions), output);
  }
}

bool FilterChain::listens_to(const MemoryId& entity) const {
  return std::ranges::any_of(stages_,
                             [&](const Stage& stage) { return stage.filter->listens_to(entity); });
}

HeldSnapshots FilterChain::held() const {
  HeldSnapshots total;
  for (const Stage& stage : stages_) {
    const HeldSnapshots held = stage.filter->held();
    total.snapshots += held.snapshots;
    total.bytes += held.bytes;
  }
  return total;
}

std::vector<FilterCounters> FilterChain::counters() const {
  std::vector<FilterCounters> all;
  for (const Stage& stage : stages_) {
    all.push_back(stage.counters);
    all.back().held = stage.filter->held();
  }
  return all;
}

}  // namespace engram::ltm
