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

/// A snapshot in packed form, as it is written to and read from the store.
struct PackedSnapshot {
  MemoryId entity;
  Time time{};
  std::vector<PackedInstance> instances;
  uint64_t raw_bytes = 0;  ///< Plain size of the values, in bytes.
  uint64_t dropped = 0;  ///< Snapshots of this entity that filters dropped since the previous one.
  uint64_t dropped_bytes = 0;  ///< Their plain bytes.

  /// True if any of its instances is augmented.
  [[nodiscard]] bool is_augmented() const {
    return std::ranges::any_of(
        instances, [](const auto& instance) { return instance.metadata.is_augmented(); });
  }
};

/// Decodes the media and returns the plain snapshot. Errors: kDataLoss if media do not decode.
Result<Snapshot> unpack(const PackedSnapshot& packed, MediumDecoder& decoder);
Result<Snapshot> unpack(const PackedSnapshot& packed);

}  // namespace engram::ltm
