// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "speech/facts/known_facts.h"

namespace engram::speech {

/// What a memory told at a moment, of which the memory may know the future by now.
///
/// Nothing that was recorded later is in it: an execution that ended later is running, without its
/// end, its reason, what stopped it and what only later events told of it. Only names are those of
/// today: what things, places, skills and persons are called.
///
/// Owns: the executions that it changes; `facts` must outlive it, and must not be refreshed before.
/// Threading: one thread.
/// Complexity: looks at the times of each execution once, and copies the few of which more was told
/// later.
class FactsAsOf {
 public:
  FactsAsOf(KnownFacts& facts, Time now);

  FactsAsOf(const FactsAsOf&) = delete;
  FactsAsOf& operator=(const FactsAsOf&) = delete;

  [[nodiscard]] Time now() const { return now_; }
  [[nodiscard]] const KnownWorld& world() const { return facts_.world(); }
  [[nodiscard]] const KnownFacts& names() const { return facts_; }

  /// Whether an ID may be told: its snapshot was there, or it is of no snapshot.
  [[nodiscard]] bool has(const ltm::MemoryId& id) const { return !id.time() || *id.time() <= now_; }

  /// In the order of their starts, none of them null; each list below in the order of time.
  [[nodiscard]] const std::vector<const Execution*>& executions() const { return executions_; }
  [[nodiscard]] std::span<const SpokenWords> words() const { return words_; }
  [[nodiscard]] std::span<const TaskPlan> plans() const { return plans_; }
  [[nodiscard]] std::span<const RefusedRequest> refusals() const { return refusals_; }
  [[nodiscard]] std::span<const DriveNote> drives() const { return drives_; }

  /// As those of KnownFacts, with all times cut at now().
  [[nodiscard]] const TaskPlan* plan_at(const ltm::MemoryId& id) const;
  [[nodiscard]] const SpokenWords* words_at(const ltm::MemoryId& id) const;
  Result<std::vector<KnownFacts::Cause>> causes_of(const Execution& execution);
  Result<std::optional<ThingState>> thing_at(const ltm::MemoryId& entity, Time time);
  Result<std::vector<ThingState>> things_at(Time time);
  Result<std::optional<ThingState>> last_state(const ltm::MemoryId& entity, Time from, Time to,
                                               const KnownFacts::StateTest& fits);
  Result<std::optional<ThingState>> first_state(const ltm::MemoryId& entity, Time from, Time to,
                                                const KnownFacts::StateTest& fits);
  Result<std::optional<RobotState>> robot_at(Time time);
  Result<std::optional<KnownFacts::Way>> way_of_robot(Time from, Time to);

 private:
  KnownFacts& facts_;
  const Time now_;
  std::vector<const Execution*> executions_;
  std::deque<Execution> changed_;  ///< Those of which more was told later, as they were known.
  std::span<const SpokenWords> words_;
  std::span<const TaskPlan> plans_;
  std::span<const RefusedRequest> refusals_;
  std::span<const DriveNote> drives_;
};

}  // namespace engram::speech
