// SPDX-License-Identifier: Apache-2.0
#include "ltm/forgetting/fade_report.h"

#include <algorithm>

namespace engram::ltm {

uint64_t FadeReport::faded() const {
  uint64_t sum = 0;
  for (const auto& [id, entity] : entities) sum += entity.faded;
  return sum;
}

uint64_t FadeReport::settled() const {
  uint64_t sum = faded();
  for (const auto& [id, entity] : entities) sum += entity.kept;
  return sum;
}

void FadeReport::add(const FadeReport& later) {
  for (const auto& [id, round] : later.entities) {
    EntityFadeReport& sum = entities[id];
    sum.faded += round.faded;
    sum.kept += round.kept;
    sum.waiting = round.waiting;
    sum.bytes_before += round.bytes_before;
    sum.bytes_after += round.bytes_after;
    sum.expected_db = std::min(sum.expected_db, round.expected_db);
    sum.certain_db = std::min(sum.certain_db, round.certain_db);
  }
  is_cancelled = is_cancelled || later.is_cancelled;
}

}  // namespace engram::ltm
