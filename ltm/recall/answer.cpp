// SPDX-License-Identifier: Apache-2.0
#include "ltm/recall/answer.h"

#include <algorithm>

namespace engram::ltm {

QueryResult Answer::to_result() && {
  QueryResult result(is_ids_only);
  for (RecalledEntity& entity : entities) {
    EntityResult& one = result.add_entity(entity.id);
    for (RecalledSnapshot& snapshot : entity.snapshots) one.add(std::move(snapshot.answer));
  }
  return result;
}

RecalledSnapshot recalled(SharedSnapshot held, const std::vector<int32_t>& instances,
                          bool is_ids_only) {
  RecalledSnapshot recalled;
  recalled.answer.time = held->time;
  if (held->is_augmented()) recalled.answer.source = Source::kAugmented;
  for (size_t i = 0; i < held->instances.size(); ++i) {
    const auto index = static_cast<int32_t>(i);
    if (!instances.empty() && !std::ranges::binary_search(instances, index)) continue;
    const Instance& instance = held->instances[i];
    recalled.answer.instances.push_back(
        is_ids_only ? InstanceResult{index, {}, {}}
                    : InstanceResult{index, instance.data, instance.metadata});
  }
  recalled.held = std::move(held);
  return recalled;
}

}  // namespace engram::ltm
