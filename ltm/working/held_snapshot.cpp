// SPDX-License-Identifier: Apache-2.0
#include "ltm/working/held_snapshot.h"

#include <algorithm>

#include "ltm/idf/held_bytes.h"
#include "ltm/working/memory_limits.h"

namespace engram::ltm {

SharedSnapshot hold_untyped(Snapshot snapshot, std::vector<Buffer> encoded) {
  auto held = CheckedSnapshot::check<HeldSnapshot>(std::move(snapshot), {}, std::move(encoded));
  return held.value().snapshot;
}

size_t HeldSnapshot::ram_bytes() const {
  size_t bytes = kSnapshotOverhead;
  // Arrays lie in the bytes in which they came.
  for (const Buffer& data : encoded) bytes += data.size();
  for (const Instance& instance : instances)
    bytes +=
        idf::held_bytes(instance.data) + (encoded.empty() ? idf::element_bytes(instance.data) : 0);
  return bytes;
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
