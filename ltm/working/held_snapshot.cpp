// SPDX-License-Identifier: Apache-2.0
#include "ltm/working/held_snapshot.h"

#include <algorithm>

namespace engram::ltm {

SharedSnapshot hold_untyped(Snapshot snapshot, std::vector<Buffer> encoded) {
  auto held = CheckedSnapshot::check<HeldSnapshot>(std::move(snapshot), {}, std::move(encoded));
  return held.value().snapshot;
}

SnapshotResult result_of(const HeldSnapshot& held, const std::vector<int32_t>& instances,
                         bool is_ids_only) {
  SnapshotResult result;
  result.time = held.time;
  if (held.is_augmented()) result.source = Source::kAugmented;
  for (size_t i = 0; i < held.instances.size(); ++i) {
    const auto index = static_cast<int32_t>(i);
    if (!instances.empty() && !std::ranges::binary_search(instances, index)) continue;
    const Instance& instance = held.instances[i];
    result.instances.push_back(is_ids_only
                                   ? InstanceResult{index, {}, {}}
                                   : InstanceResult{index, instance.data, instance.metadata});
  }
  return result;
}

}  // namespace engram::ltm
