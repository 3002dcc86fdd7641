// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "speech/facts/known_facts.h"
#include "speech/program/outcome.h"
#include "speech/program/period.h"

namespace engram::speech {

/// An outcome in English. It says what the outcome holds, and nothing besides; of what is unknown
/// it says what was looked for. Names of the memory are printed so that a terminal does not obey
/// them.
[[nodiscard]] std::string tell(const Outcome& outcome, const KnownFacts& facts, DayZone zone);

}  // namespace engram::speech
