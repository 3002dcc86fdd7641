// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "ltm/core/time.h"
#include "ltm/memory/action_outcome.h"
#include "ltm/memory/memory_id.h"

namespace engram::speech {

/// What an event of an execution may tell first.
enum class ToldMember : size_t { kHand, kThing, kPlace, kRequest, kPlan, kThingBefore, kCount };

/// One execution of a skill, from the events that tell of it. All IDs are of instances, but for
/// those of things and places, which are entities.
struct Execution {
  ltm::MemoryId start_id;               ///< The first event that tells of it.
  std::optional<ltm::MemoryId> end_id;  ///< The event at which it ended; nothing: none is known.
  std::string provider;                 ///< Empty: its events do not name one.
  std::string skill;                    ///< Without its provider.
  /// kRunning: no end is known. kUnknown: it was lost.
  ltm::ActionOutcome outcome = ltm::ActionOutcome::kRunning;
  std::string reason;  ///< What was measured, or why it ended.
  Time started{};
  std::optional<Time> ended;
  std::string hand;                    ///< Its words; empty: none is told.
  std::optional<ltm::MemoryId> thing;  ///< What it was done with.
  std::optional<ltm::MemoryId> place;  ///< Where it was done, or where it led.
  std::optional<ltm::MemoryId> request;
  std::optional<ltm::MemoryId> plan;
  std::vector<ltm::MemoryId> stopped_by;
  std::optional<ltm::MemoryId> thing_before;  ///< The thing as it was when it began,
  std::optional<ltm::MemoryId> thing_after;   ///< and when it ended.
  /// What the events themselves were read from: joints and images of a deed that nobody told.
  std::vector<ltm::MemoryId> read_from;
  /// When the event was that told each member first. What a later one tells was not known before.
  std::array<Time, static_cast<size_t>(ToldMember::kCount)> told_at{};

  /// No end is known, but it was over by then: the same was begun again with the same hand.
  std::optional<Time> over_by;

  /// Whether it may have gone on at some time from `from` to `to`. What ends at a moment does not
  /// go on at it, so that of two that follow each other only one does.
  [[nodiscard]] bool is_within(Time from, Time to) const {
    return started <= to && (latest_end() > from || started == from);
  }

  /// Up to when it may have gone on.
  [[nodiscard]] Time latest_end() const { return ended ? *ended : over_by.value_or(Time::max()); }

  /// Whether it is known when it ended. What was lost ended at some time before that was found out.
  [[nodiscard]] bool has_known_end() const {
    return ended.has_value() && outcome != ltm::ActionOutcome::kUnknown;
  }

  /// Whether it goes on at `now`, as far as anybody was told.
  [[nodiscard]] bool goes_on(Time now) const { return !ended && latest_end() > now; }
};

/// What somebody said.
struct SpokenWords {
  ltm::MemoryId id;
  Time time{};
  std::string speaker;
  std::string text;
};

/// One step of a plan.
struct PlannedStep {
  std::string skill;
  std::optional<ltm::MemoryId> thing;
  std::optional<ltm::MemoryId> place;
};

/// What the robot meant to do.
struct TaskPlan {
  ltm::MemoryId id;
  Time time{};
  std::string goal;
  std::optional<ltm::MemoryId> command;  ///< The words that it follows.
  std::vector<PlannedStep> steps;
};

/// A request that was not carried out.
struct RefusedRequest {
  ltm::MemoryId id;
  Time time{};
  std::string provider;  ///< Empty: the request did not name one.
  std::string skill;     ///< Without its provider.
  std::string reason;
  std::optional<ltm::MemoryId> request;
};

/// What happened to a drive around obstacles.
struct DriveNote {
  ltm::MemoryId id;
  Time time{};
  std::string kind;  ///< "started", "replanned", "blocked", "arrived", "refused", "trapped", ...
  std::string goal;
  std::string reason;
  std::optional<ltm::MemoryId> request;
  std::vector<ltm::MemoryId> blocked_by;
};

}  // namespace engram::speech
