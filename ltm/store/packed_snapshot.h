// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "ltm/codec/medium_decoder.h"
#include "ltm/codec/packed_value.h"
#include "ltm/memory/snapshot.h"

namespace engram::ltm {

struct PackedInstance {
  PackedValue value;
  InstanceMetadata metadata;
};

/// One snapshot on its way into the store or out of it, values packed.
struct PackedSnapshot {
  MemoryId entity;
  Time time{};
  std::vector<PackedInstance> instances;
  uint64_t raw_bytes = 0;      ///< Of the plain values.
  uint64_t dropped = 0;        ///< Snapshots of this entity that filters dropped since the last.
  uint64_t dropped_bytes = 0;  ///< Their plain bytes.

  /// Whether any of its instances is.
  [[nodiscard]] bool is_augmented() const {
    return std::ranges::any_of(
        instances, [](const auto& instance) { return instance.metadata.is_augmented(); });
  }
};

/// Errors: kDataLoss where media do not decode.
Result<Snapshot> unpack(const PackedSnapshot& packed, MediumDecoder& decoder);
Result<Snapshot> unpack(const PackedSnapshot& packed);

}  // namespace engram::ltm
