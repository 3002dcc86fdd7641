// SPDX-License-Identifier: Apache-2.0
#include "ltm/filter/filter_chain.h"

#include <algorithm>

namespace engram::ltm {

uint64_t FilterCounters::dropped() const {
  uint64_t total = 0;
  for (const auto& [reason, count] : dropped_by) total += count;
  return total;
}

Result<FilterChain> FilterChain::create(std::vector<FilterOptions> filters,
                                        const std::optional<LinkedBuffer::Options>& linked) {
  FilterChain chain(std::move(filters));
  if (linked) chain.linked_.emplace(*linked);
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
  drop_unlinked(output);
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
  if (linked_) linked_->add_held_times(times);
}

void FilterChain::forget(const TimeSet& times, Output& output) {
  for (size_t i = 0; i < stages_.size(); ++i) {
    FilterDecisions decisions;
    if (!stages_[i].filter->forget(times, decisions)) replace_filter(i);
    settle(i, std::move(decisions), output);
  }
  if (!linked_) return;
  std::vector<LinkedBuffer::Dropped> gone = linked_->give_up(times);
  for (LinkedBuffer::Dropped& each : gone) each.reason = Filter::kForgotten;
  count_drops(std::move(gone), output);
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
  if (linked_) count_drops(linked_->give_up(time), output);
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
  FilterDecisions decisions = undecided();
  stages_[stage].filter->offer(std::move(candidate), decisions);
  settle(stage, std::move(decisions), output);
}

void FilterChain::settle(size_t stage, FilterDecisions decisions, Output& output) {
  for (FilterDecisions::Drop& drop : decisions.dropped) {
    if (!drop.candidate) {
      count_drop(stage, drop.reason, drop.bytes, output);
      continue;
    }
    if (auto wanted = linked_->add({*std::move(drop.candidate), stage, drop.reason}))
      keep_linked(*std::move(wanted), output);
  }
  stages_[stage].counters.kept += decisions.kept.size();
  for (Candidate& kept : decisions.kept) pass(stage + 1, std::move(kept), output);
}

FilterDecisions FilterChain::undecided() const {
  FilterDecisions decisions;
  decisions.has_dropped = linked_.has_value();
  return decisions;
}

void FilterChain::count_drop(size_t stage, std::string_view reason, uint64_t bytes,
                             Output& output) {
  FilterCounters& counters = stages_[stage].counters;
  const auto known = counters.dropped_by.find(reason);
  if (known == counters.dropped_by.end())
    counters.dropped_by.emplace(reason, 1);
  else
    ++known->second;
  counters.dropped_bytes += bytes;
  ++output.dropped;
  output.dropped_bytes += bytes;
}

void FilterChain::count_drops(std::vector<LinkedBuffer::Dropped> dropped, Output& output) {
  for (const LinkedBuffer::Dropped& each : dropped)
    count_drop(each.stage, each.reason, each.candidate.raw_bytes, output);
}

void FilterChain::keep_linked(LinkedBuffer::Dropped dropped, Output& output) {
  ++stages_[dropped.stage].counters.kept;
  output.kept.push_back(std::move(dropped.candidate));
}

void FilterChain::want(Time time, Output& output) {
  if (!linked_) return;
  if (auto wanted = linked_->want(time)) keep_linked(*std::move(wanted), output);
}

void FilterChain::drop_unlinked(Output& output) {
  if (linked_) count_drops(linked_->give_up_all(), output);
}

void FilterChain::flush(Output& output) {
  // In the order of the chain: what one filter releases, the next ones still decide on.
  for (size_t i = 0; i < stages_.size(); ++i) {
    FilterDecisions decisions = undecided();
    stages_[i].filter->flush(decisions);
    settle(i, std::move(decisions), output);
  }
}

void FilterChain::notice(const Snapshot& snapshot, const std::optional<idf::Type>& type,
                         Output& output) {
  for (size_t i = 0; i < stages_.size(); ++i) {
    FilterDecisions decisions = undecided();
    stages_[i].filter->notice(snapshot, type, decisions);
    settle(i, std::move(decisions), output);
  }
}

bool FilterChain::listens_to(const MemoryId& entity) const {
  return std::ranges::any_of(stages_,
                             [&](const Stage& stage) { return stage.filter->listens_to(entity); });
}

HeldSnapshots FilterChain::held() const {
  HeldSnapshots total = linked_ ? linked_->held() : HeldSnapshots();
  for (const Stage& stage : stages_) {
    const HeldSnapshots held = stage.filter->held();
    total.snapshots += held.snapshots;
    total.bytes += held.bytes;
  }
  return total;
}

std::vector<FilterCounters> FilterChain::counters() const {
  std::vector<FilterCounters> all;
  for (size_t i = 0; i < stages_.size(); ++i) {
    all.push_back(stages_[i].counters);
    HeldSnapshots& held = all.back().held;
    held = stages_[i].filter->held();
    if (!linked_) continue;
    const HeldSnapshots linked = linked_->held_of(i);
    held.snapshots += linked.snapshots;
    held.bytes += linked.bytes;
  }
  return all;
}

}  // namespace engram::ltm
