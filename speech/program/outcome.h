// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ltm/core/time.h"
#include "speech/facts/answer_value.h"
#include "speech/facts/known_world.h"
#include "speech/facts/records.h"
#include "speech/program/program.h"

namespace engram::speech {

/// An instance that an answer was read from, and what it is to the answer.
struct Evidence {
  ltm::MemoryId id;
  std::string role;  ///< "started", "ended", "request", "plan", "words", "thing", "looked at", ...

  friend bool operator==(const Evidence&, const Evidence&) = default;
};

/// What a program found: a value, what it was read from, and the records for whoever tells it.
struct Outcome {
  static constexpr size_t kMaxEvidence = 200;

  Program program;
  AnswerValue value = answers::Unknown{};
  std::vector<Evidence> evidence;  ///< Empty where the value is unknown.
  /// What was looked for, in words: "executions of pick with salt, yesterday". Where the value is
  /// unknown, also what was missing.
  std::string looked_for;
  std::string missing;  ///< Why the value is unknown, as a clause: "no thing is called elephant".

  std::vector<Execution> executions;
  std::vector<SpokenWords> words;
  std::vector<TaskPlan> plans;
  std::vector<ThingState> states;
  std::vector<PlannedStep> steps;  ///< Of the step `instead`.
  Time now = Time::max();          ///< When it was asked.

  /// Adds an ID once, no more than kMaxEvidence, and none of a snapshot after `now`.
  void cite(const ltm::MemoryId& id, std::string_view role);
  /// Cites both events of an execution, and what they were read from.
  void cite(const Execution& execution);
  /// Cites the state of a thing, and what it was read from.
  void cite(const ThingState& state);
};

}  // namespace engram::speech
