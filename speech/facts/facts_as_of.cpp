// SPDX-License-Identifier: Apache-2.0
#include "speech/facts/facts_as_of.h"

#include <algorithm>

namespace engram::speech {

namespace {

/// Those of records in the order of time that were there at `now`.
template <typename Record>
std::span<const Record> up_to(const std::vector<Record>& records, Time now) {
  const auto end = std::upper_bound(records.begin(), records.end(), now,
                                    [](Time time, const Record& one) { return time < one.time; });
  return {records.begin(), end};
}

/// An end may be told of later than it was, and then nobody knew of it in between.
bool is_ended_at(const Execution& execution, Time now) {
  return execution.ended && *execution.ended <= now &&
         (!execution.end_id || execution.end_id->time().value_or(now) <= now);
}

bool is_told_at(const Execution& execution, ToldMember member, Time now) {
  return execution.told_at.at(static_cast<size_t>(member)) <= now;
}

bool is_whole_at(const Execution& execution, Time now) {
  return (!execution.ended || is_ended_at(execution, now)) &&
         std::all_of(execution.told_at.begin(), execution.told_at.end(),
                     [now](Time told) { return told <= now; });
}

/// An execution without what was told of it after `now`.
Execution as_known_at(const Execution& execution, Time now) {
  Execution known = execution;
  if (execution.ended && !is_ended_at(execution, now)) {
    known.end_id.reset();
    known.ended.reset();
    known.outcome = ltm::ActionOutcome::kRunning;
    known.reason.clear();
    known.stopped_by.clear();
    known.thing_after.reset();
  }
  const auto forget = [&](std::optional<ltm::MemoryId>& link, ToldMember member) {
    const bool is_later = link && link->time().value_or(now) > now;
    if (is_later || !is_told_at(execution, member, now)) link.reset();
  };
  if (!is_told_at(execution, ToldMember::kHand, now)) known.hand.clear();
  forget(known.thing, ToldMember::kThing);
  forget(known.place, ToldMember::kPlace);
  forget(known.request, ToldMember::kRequest);
  forget(known.plan, ToldMember::kPlan);
  forget(known.thing_before, ToldMember::kThingBefore);
  return known;
}

}  // namespace

FactsAsOf::FactsAsOf(KnownFacts& facts, Time now)
    : facts_(facts),
      now_(now),
      words_(up_to(facts.words(), now)),
      plans_(up_to(facts.plans(), now)),
      refusals_(up_to(facts.refusals(), now)),
      drives_(up_to(facts.drives(), now)) {
  executions_.reserve(facts.executions().size());
  for (const Execution& execution : facts.executions()) {
    if (execution.started > now) break;
    if (execution.start_id.time().value_or(now) > now) continue;
    executions_.push_back(is_whole_at(execution, now)
                              ? &execution
                              : &changed_.emplace_back(as_known_at(execution, now)));
  }
}

const TaskPlan* FactsAsOf::plan_at(const ltm::MemoryId& id) const {
  return has(id) ? facts_.plan_at(id) : nullptr;
}

const SpokenWords* FactsAsOf::words_at(const ltm::MemoryId& id) const {
  return has(id) ? facts_.words_at(id) : nullptr;
}

Result<std::vector<KnownFacts::Cause>> FactsAsOf::causes_of(const Execution& execution) {
  ENGRAM_ASSIGN_OR_RETURN(auto causes, facts_.causes_of(execution));
  std::erase_if(causes, [this](const KnownFacts::Cause& cause) { return !has(cause.id); });
  return causes;
}

Result<std::optional<ThingState>> FactsAsOf::thing_at(const ltm::MemoryId& entity, Time time) {
  return facts_.thing_at(entity, std::min(time, now_));
}

Result<std::vector<ThingState>> FactsAsOf::things_at(Time time) {
  return facts_.things_at(std::min(time, now_));
}

Result<std::optional<ThingState>> FactsAsOf::last_state(const ltm::MemoryId& entity, Time from,
                                                        Time to,
                                                        const KnownFacts::StateTest& fits) {
  return facts_.last_state(entity, from, std::min(to, now_), fits);
}

Result<std::optional<ThingState>> FactsAsOf::first_state(const ltm::MemoryId& entity, Time from,
                                                         Time to,
                                                         const KnownFacts::StateTest& fits) {
  return facts_.first_state(entity, from, std::min(to, now_), fits);
}

Result<std::optional<RobotState>> FactsAsOf::robot_at(Time time) {
  return facts_.robot_at(std::min(time, now_));
}

Result<std::optional<KnownFacts::Way>> FactsAsOf::way_of_robot(Time from, Time to) {
  return facts_.way_of_robot(from, std::min(to, now_));
}

}  // namespace engram::speech
