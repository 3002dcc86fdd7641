// SPDX-License-Identifier: Apache-2.0
#include "speech/program/outcome.h"

#include <algorithm>

namespace engram::speech {

void Outcome::cite(const ltm::MemoryId& id, std::string_view role) {
  if (evidence.size() >= kMaxEvidence || id.time().value_or(now) > now) return;
  const bool is_cited = std::any_of(evidence.begin(), evidence.end(),
                                    [&](const Evidence& known) { return known.id == id; });
  if (!is_cited) evidence.push_back({id, std::string(role)});
}

void Outcome::cite(const Execution& execution) {
  cite(execution.start_id, "started");
  if (execution.end_id) cite(*execution.end_id, "ended");
  for (const ltm::MemoryId& id : execution.read_from) cite(id, "read from");
}

void Outcome::cite(const ThingState& state) {
  cite(state.id, "thing");
  for (const ltm::MemoryId& id : state.read_from) cite(id, "read from");
}

}  // namespace engram::speech
