// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "speech/facts/known_facts.h"
#include "speech/program/period.h"

namespace engram::speech {

/// What a sentence of a narration is about. Each is below the one before it.
enum class NarrationLevel {
  kWhole,    ///< The whole time.
  kPlan,     ///< What was asked for, and what became of it; or actions that no plan led to.
  kFailure,  ///< What went wrong with it.
};

[[nodiscard]] std::string_view name_of(NarrationLevel level);

/// One sentence, and the instances that it was read from.
struct NarrationSentence {
  NarrationLevel level{};
  std::string text;
  std::vector<ltm::MemoryId> links;
};

/// Tells what the robot did in a time in at most `max_sentences`, in the order of time: first of
/// all of it, then each plan with what became of it, and below it what failed or was stopped. Where
/// there is too much, failures are told before what went well, and what is left out is counted.
/// Nothing after `now` is told, and what ended later was running then. Nothing where the memory has
/// nothing of that time. Errors: those of Memory::query.
Result<std::vector<NarrationSentence>> tell_period(KnownFacts& facts, Period period, Time now,
                                                   DayZone zone, size_t max_sentences = 10);

}  // namespace engram::speech
