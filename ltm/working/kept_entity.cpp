// SPDX-License-Identifier: Apache-2.0
#include "ltm/working/kept_entity.h"

#include <algorithm>
#include <cmath>

namespace engram::ltm {

namespace {

/// The weight of a read of an entity for the entities that it links to.
constexpr double kLinkShare = 0.5;

}  // namespace

double KeptEntity::read_rate_at(Time now, Duration half_life) {
  const double passed = to_seconds(now - rated) / to_seconds(half_life);
  if (passed > 0) {
    read_rate *= std::exp2(-passed);
    rated = now;
  }
  read_rate += reads.exchange(0, std::memory_order_relaxed);
  return read_rate;
}

void KeptEntity::link_to(std::vector<KeptEntity*> targets) {
  if (targets == links) return;
  for (KeptEntity* target : links) std::erase(target->linked_by, this);
  // Either both know of the link or neither does.
  std::erase_if(targets,
                [](const KeptEntity* target) { return target->linked_by.size() >= kMaxLinkedBy; });
  links = std::move(targets);
  for (KeptEntity* target : links) target->linked_by.push_back(this);
}

void KeptEntity::unlink() {
  link_to({});
  for (KeptEntity* source : linked_by) std::erase(source->links, this);
  linked_by.clear();
}

double leaving_gain(KeptEntity& entity, Time now, Duration read_half_life) {
  const auto& oldest = entity.history[entity.history.leaving()];
  double reads = entity.read_rate_at(now, read_half_life);
  for (KeptEntity* source : entity.linked_by)
    reads += kLinkShare * source->read_rate_at(now, read_half_life);
  const double held_s = std::max(to_seconds(now - oldest.arrived), 1e-6);
  return held_s * static_cast<double>(oldest.bytes) / (1 + reads);
}

}  // namespace engram::ltm
