// SPDX-License-Identifier: Apache-2.0
#include "ltm/likeness/compared_past.h"

#include <algorithm>
#include <iterator>

#include "ltm/recall/joined_past.h"

namespace engram::ltm {

const std::vector<SharedSnapshot>& ComparedPast::held(const MemoryId& entity) {
  const auto [at, is_new] = held_.try_emplace(entity);
  if (is_new && memory_ != nullptr) at->second = memory_->all_of(entity);
  return at->second;
}

std::vector<MemoryId> ComparedPast::matching(const Query& query) {
  std::vector<MemoryId> stored = store_.matching(query);
  if (memory_ == nullptr) return stored;
  const std::vector<MemoryId> held = memory_->matching(query);
  std::vector<MemoryId> all;
  std::ranges::set_union(stored, held, std::back_inserter(all));
  return all;
}

Result<std::unique_ptr<EntityPast>> ComparedPast::of(const MemoryId& entity) {
  const std::vector<SharedSnapshot>& held = this->held(entity);
  if (held.empty()) return store_.of(entity);
  std::optional<Time> until;
  if (store().has(entity)) {
    ENGRAM_ASSIGN_OR_RETURN(const Timeline* timeline, store().timeline(entity));
    until = timeline->last();
  }
  return join_pasts({
      .newest = held.back(),
      .held = [&held] { return held; },
      .until = [until] { return until; },
      .stored = [this, entity] { return store_.of(entity); },
  });
}

}  // namespace engram::ltm
