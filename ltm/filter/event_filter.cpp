// SPDX-License-Identifier: Apache-2.0
#include "ltm/filter/event_filter.h"

#include <algorithm>

namespace engram::ltm {

namespace {

constexpr Duration kLongestWindow = std::chrono::hours(24);

Status check_window(std::string_view filter, std::string_view option, Duration length) {
  if (length >= Duration(0) && length <= kLongestWindow) return {};
  return invalid_argument("{} filter: {} is {}, needs 0s to {}", filter, option, to_string(length),
                          to_string(kLongestWindow));
}

Status check_events(std::string_view filter, const std::vector<EventRule>& events) {
  if (events.empty()) return invalid_argument("{} filter: needs one event at least", filter);
  for (const EventRule& event : events) ENGRAM_RETURN_IF_ERROR(event.validate());
  return {};
}

}  // namespace

EventWindows::EventWindows(const std::vector<EventRule>& events,
                           const WindowBuffer::Options& windows)
    : buffer_(windows) {
  for (const EventRule& event : events) detectors_.emplace_back(event);
}

void EventWindows::offer(Candidate candidate, bool is_wanted, FilterDecisions& decisions) {
  const MemoryId& own = candidate.snapshot.entity;
  bool is_event = false;
  for (EventDetector& detector : detectors_)
    if (detector.is_for(own, own) && detector.is_event(candidate.snapshot, candidate.type))
      is_event = true;
  const Time time = candidate.snapshot.time;
  buffer_.add(std::move(candidate), is_wanted);
  if (is_event) buffer_.mark(time);
  buffer_.settle(decisions);
}

bool EventWindows::listens_to(const MemoryId& entity) const {
  return std::ranges::any_of(detectors_, [&](const EventDetector& detector) {
    return detector.rule().entity && detector.rule().entity->matches(entity);
  });
}

void EventWindows::notice(const Snapshot& snapshot, const std::optional<idf::Type>& type,
                          FilterDecisions& decisions) {
  bool is_event = false;
  for (EventDetector& detector : detectors_)
    if (detector.rule().entity && detector.rule().entity->matches(snapshot.entity) &&
        detector.is_event(snapshot, type))
      is_event = true;
  if (!is_event) return;
  buffer_.mark(snapshot.time);
  buffer_.settle(decisions);
}

Status ImportanceFilter::Options::validate() const {
  ENGRAM_RETURN_IF_ERROR(check_events("importance", events));
  ENGRAM_RETURN_IF_ERROR(check_window("importance", "before", before));
  ENGRAM_RETURN_IF_ERROR(check_window("importance", "after", after));
  if (base_rate_hz) ENGRAM_RETURN_IF_ERROR(FrequencyFilter::Options{*base_rate_hz}.validate());
  return {};
}

Result<ImportanceFilter> ImportanceFilter::create(const Options& options) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  std::optional<FrequencyFilter> base;
  if (options.base_rate_hz) {
    ENGRAM_ASSIGN_OR_RETURN(base, FrequencyFilter::create({*options.base_rate_hz}));
  }
  return ImportanceFilter(EventWindows(options.events, {options.before, options.after,
                                                        options.max_held_bytes, "unimportant"}),
                          std::move(base));
}

void ImportanceFilter::offer(Candidate candidate, FilterDecisions& decisions) {
  const bool is_base = base_ && base_->is_due(candidate.snapshot.time);
  windows_.offer(std::move(candidate), is_base, decisions);
}

Status TriggerFilter::Options::validate() const {
  ENGRAM_RETURN_IF_ERROR(check_events("trigger", events));
  ENGRAM_RETURN_IF_ERROR(check_window("trigger", "before", before));
  if (after) ENGRAM_RETURN_IF_ERROR(check_window("trigger", "after", *after));
  return {};
}

Result<TriggerFilter> TriggerFilter::create(const Options& options) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  return TriggerFilter(EventWindows(
      options.events, {options.before, options.after, options.max_held_bytes, "no trigger"}));
}

}  // namespace engram::ltm
