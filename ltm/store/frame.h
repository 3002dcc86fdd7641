// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "ltm/store/packed_snapshot.h"

namespace engram::ltm {

/// Payload of a journal frame: one packed snapshot. A snapshot without instances only says what
/// was dropped after the one before.
/// Images of a group that has no loss are written singly, as frames stand alone.
/// Errors: kInvalidArgument where a value nests too deep or an image is of a group with loss: it
/// would be encoded once more when it is sealed. Those of pack_alone.
/// Source: docs/format.md, section "Journal".
Result<std::vector<std::byte>> encode_frame(const PackedSnapshot& snapshot);

/// Safe on hostile bytes; media view `payload`. Errors: kDataLoss.
Result<PackedSnapshot> decode_frame(const Buffer& payload);

/// What an index needs of a frame, without unpacking its values. Errors: kDataLoss.
struct FrameHead {
  MemoryId entity;
  Time time{};
  uint64_t raw_bytes = 0;
  uint64_t dropped = 0;
  uint64_t dropped_bytes = 0;
  size_t instances = 0;
  bool is_augmented = false;  ///< Any of them is.
};
Result<FrameHead> decode_frame_head(const Buffer& payload);

/// The metadata of an instance as a value, and back.
[[nodiscard]] idf::Data metadata_to_data(const InstanceMetadata& metadata);
Result<InstanceMetadata> metadata_from_data(const idf::Data& data);

}  // namespace engram::ltm
