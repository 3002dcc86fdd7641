// SPDX-License-Identifier: Apache-2.0
#include "ltm/recall/store_conditions.h"

#include "ltm/recall/list_moments.h"

namespace engram::ltm {

ListMoments StoreConditions::of(const MemoryId& entity) {
  return [this, entity](std::span<const Condition> conditions) -> Result<std::vector<Time>> {
    if (!past_) {
      ENGRAM_ASSIGN_OR_RETURN(past_, StorePast::open(store_, {}, StorePast::Options{}));
    }
    return list_moments(*past_, entity, is_named_)(conditions);
  };
}

}  // namespace engram::ltm
