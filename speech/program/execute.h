// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "speech/facts/known_facts.h"
#include "speech/program/outcome.h"
#include "speech/program/period.h"

namespace engram::speech {

/// Executes a program on what a memory knows. `now` is what relative times count from; nothing
/// after it is looked at, and what ended later is running (FactsAsOf).
///
/// What nothing tells of is unknown, and nothing is guessed: where the filters name a thing, a
/// place, a skill or a person that the memory does not know, where they keep no record that a step
/// needs, or where the memory has no record at all of the time that is asked about. That something
/// did not happen is known where there are records of that time, and so is that nothing did: then
/// names and events are empty, and what was looked at is cited. Errors: kInvalidArgument where the
/// program does not validate; those of Memory::query.
Result<Outcome> execute(const Program& program, KnownFacts& facts, Time now, DayZone zone);

}  // namespace engram::speech
