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

uint64_t ForgetPlan::fading() const {
  uint64_t sum = 0;
  for (const auto& [id, entity] : entities)
    for (const FadingSnapshots& part : entity.fading) sum += part.times.size();
  return sum;
}

FadeSet ForgetPlan::to_fade() const {
  FadeSet set;
  for (const auto& [id, entity] : entities)
    if (!entity.fading.empty()) set.emplace(id, entity.fading);
  return set;
}

ForgetSet ForgetPlan::to_set() const {
  ForgetSet set;
  for (const auto& [id, entity] : entities)
    if (!entity.gone.empty()) set.emplace(id, entity.gone);
  return set;
}

}  // namespace engram::ltm
