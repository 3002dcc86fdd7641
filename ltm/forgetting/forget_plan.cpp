// SPDX-License-Identifier: Apache-2.0
#include "ltm/forgetting/forget_plan.h"

namespace engram::ltm {

uint64_t ForgetPlan::snapshots() const {
  uint64_t sum = 0;
  for (const auto& [id, entity] : entities) sum += entity.gone.size();
  return sum;
}

uint64_t ForgetPlan::unsealed() const {
  uint64_t sum = 0;
  for (const auto& [id, entity] : entities) sum += entity.unsealed;
  return sum;
}

ForgetSet ForgetPlan::to_set() const {
  ForgetSet set;
  for (const auto& [id, entity] : entities)
    if (!entity.gone.empty()) set.emplace(id, entity.gone);
  return set;
}

}  // namespace engram::ltm
