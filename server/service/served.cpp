// SPDX-License-Identifier: Apache-2.0
#include "server/service/served.h"

#include <algorithm>

namespace engram::server {

ltm::QueryResult ServedAnswer::to_result() const {
  ltm::QueryResult result(is_ids_only);
  for (const ServedEntity& entity : entities) {
    ltm::EntityResult& one = result.add_entity(entity.id);
    for (const ServedSnapshot& snapshot : entity.snapshots) one.add(snapshot.answer);
  }
  return result;
}

ServedSnapshot serve(SharedSnapshot held, const std::vector<int32_t>& instances,
                     bool is_ids_only) {
  ServedSnapshot served;
  served.answer.time = held->time;
  if (held->is_augmented()) served.answer.source = ltm::Source::kAugmented;
  for (size_t i = 0; i < held->instances.size(); ++i) {
    const auto index = static_cast<int32_t>(i);
    if (!instances.empty() && !std::ranges::binary_search(instances, index)) continue;
    const ltm::Instance& instance = held->instances[i];
    served.answer.instances.push_back(
        is_ids_only ? ltm::InstanceResult{index, {}, {}}
                    : ltm::InstanceResult{index, instance.data, instance.metadata});
  }
  served.held = std::move(held);
  return served;
}

}  // namespace engram::server
