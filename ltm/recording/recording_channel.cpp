// SPDX-License-Identifier: Apache-2.0
#include "ltm/recording/recording_channel.h"

#include <algorithm>

namespace engram::ltm {

namespace {

/// The events of a filter; null if it is of a kind without events.
const std::vector<EventRule>* events_of(const FilterOptions& filter) {
  if (const auto* importance = std::get_if<ImportanceFilter::Options>(&filter))
    return &importance->events;
  if (const auto* trigger = std::get_if<TriggerFilter::Options>(&filter)) return &trigger->events;
  return nullptr;
}

/// The index of the first rule that matches; the number of rules if none does.
size_t rule_of(const Recorder::Options& options, const MemoryId& entity) {
  const auto rule = std::ranges::find_if(
      options.rules, [&](const EntityRule& each) { return each.match.matches(entity); });
  return static_cast<size_t>(rule - options.rules.begin());
}

FilterChain chain_of(const Recorder::Options& options, size_t rule) {
  std::vector<FilterOptions> filters;
  std::optional<LinkedBuffer::Options> linked;
  if (rule < options.rules.size()) {
    filters = options.rules[rule].filters;
    if (const auto keeps = options.rules[rule].keep_linked)
      linked = LinkedBuffer::Options{.keeps = *keeps};
  } else if (options.max_rate_hz) {
    filters.emplace_back(FrequencyFilter::Options{*options.max_rate_hz});
  }
  auto chain = FilterChain::create(std::move(filters), linked);
  ENGRAM_CHECK(chain.ok(), "{}", chain.status().message());
  return *std::move(chain);
}

Packer packer_of(const PackOptions& options) {
  auto packer = Packer::create(options);
  ENGRAM_CHECK(packer.ok(), "{}", packer.status().message());
  return *std::move(packer);
}

}  // namespace

void RecordingChannel::count() const {
  counters->filters = chain.counters();
  counters->dropped_by.clear();
  for (const FilterCounters& filter : counters->filters)
    if (const uint64_t count = filter.dropped(); count > 0)
      counters->dropped_by[filter.filter] += count;
  if (counters->redact_dropped > 0) counters->dropped_by["redact"] += counters->redact_dropped;
  counters->held = chain.held();
  counters->held.snapshots += pending;
  counters->held.bytes += pending_bytes;
  counters->late = chain.late();
}

RecordingChannels::RecordingChannels(const Recorder::Options& options) : options_(options) {
  for (const EntityRule& rule : options.rules) packers_.push_back(packer_of(rule.pack));
  packers_.push_back(packer_of(options.pack));
  keeps_linked_ = std::ranges::any_of(
      options.rules, [](const EntityRule& rule) { return rule.keep_linked.has_value(); });
  for (const EntityRule& rule : options.rules)
    for (const FilterOptions& filter : rule.filters)
      if (const auto* events = events_of(filter))
        for (const EventRule& event : *events)
          if (event.entity) event_sources_.push_back(*event.entity);
}

RecordingChannel* RecordingChannels::find(const MemoryId& entity) {
  const auto found = channels_.find(entity);
  return found == channels_.end() ? nullptr : &found->second;
}

RecordingChannel& RecordingChannels::of(const MemoryId& entity) {
  if (const auto known = channels_.find(entity); known != channels_.end()) return known->second;
  const size_t rule = rule_of(options_, entity);
  RecordingCounters& counters = counters_[entity];
  if (rule < options_.rules.size()) counters.rule = options_.rules[rule].name;
  RecordingChannel made{entity, chain_of(options_, rule), packers_[rule], &counters};
  made.is_event_source = std::ranges::any_of(
      event_sources_, [&](const EntityPattern& source) { return source.matches(entity); });
  RecordingChannel& channel = channels_.emplace(entity, std::move(made)).first->second;
  if (!event_sources_.empty()) connect(channel);
  return channel;
}

void RecordingChannels::connect(RecordingChannel& made) {
  for (auto& [entity, other] : channels_) {
    if (&other == &made) continue;
    if (made.is_event_source && other.chain.listens_to(made.entity))
      made.listeners.push_back(&other);
    if (!other.is_event_source || !made.chain.listens_to(entity)) continue;
    other.listeners.push_back(&made);
    // An event may come before the first snapshot of the entity whose filter it opens.
    FilterChain::Output nothing;
    if (other.last_offered) made.chain.notice(*other.last_offered, other.last_type, nothing);
  }
}

const std::map<MemoryId, RecordingCounters>& RecordingChannels::counters() const {
  for (const auto& [entity, channel] : channels_) channel.count();
  return counters_;
}

}  // namespace engram::ltm
