// SPDX-License-Identifier: Apache-2.0
#include "ltm/recall/overlaid_past.h"

#include <algorithm>
#include <iterator>

#include "ltm/recall/joined_past.h"

namespace engram::ltm {

std::vector<MemoryId> OverlaidPast::matching(const Query& query) {
  const std::vector<MemoryId> held = memory_.matching(query);
  std::vector<MemoryId> below = below_->matching(query);
  if (held.empty()) return below;
  std::vector<MemoryId> all;
  all.reserve(held.size() + below.size());
  std::ranges::set_union(held, below, std::back_inserter(all));
  return all;
}

Result<std::unique_ptr<EntityPast>> OverlaidPast::of(const MemoryId& entity) {
  std::vector<SharedSnapshot> newest = memory_.all_of(entity, 1);
  ENGRAM_ASSIGN_OR_RETURN(auto below, below_->of(entity));
  if (newest.empty()) return below;
  std::optional<Time> last;
  if (below) {
    ENGRAM_ASSIGN_OR_RETURN(last, below->last());
  }
  // Opened once at most, by its contract.
  auto shared = std::make_shared<std::unique_ptr<EntityPast>>(std::move(below));
  return join_pasts({
      .newest = std::move(newest.front()),
      .held = [this, entity] { return memory_.all_of(entity); },
      .until = [last] { return last; },
      .stored = [shared]() -> Result<std::unique_ptr<EntityPast>> { return std::move(*shared); },
  });
}

}  // namespace engram::ltm
