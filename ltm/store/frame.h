// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "ltm/store/packed_snapshot.h"

namespace engram::ltm {

/// Encodes one packed snapshot as the payload of a journal frame. A snapshot without instances only
/// records how many snapshots filters dropped since the previous one.
/// Frames must be readable alone, so images of a lossless group are written one by one.
/// Errors: kInvalidArgument if a value nests too deep, or if an image is in a group of a lossy
/// codec, because sealing would encode it with loss a second time; those of pack_alone.
/// Source: docs/format.md, section "Journal".
Result<std::vector<std::byte>> encode_frame(const PackedSnapshot& snapshot);

/// Decodes the payload of a frame. Safe on hostile bytes. The media of the result are views of
/// `payload`. Errors: kDataLoss.
Result<PackedSnapshot> decode_frame(const Buffer& payload);

/// The fields of a frame that an index needs. They are read without unpacking its values.
struct FrameHead {
  MemoryId entity;
  Time time{};
  uint64_t raw_bytes = 0;
  uint64_t dropped = 0;
  uint64_t dropped_bytes = 0;
  size_t instances = 0;
  bool is_augmented = false;  ///< At least one instance is augmented.
};
/// Reads the head of a frame. Errors: kDataLoss.
Result<FrameHead> decode_frame_head(const Buffer& payload);

/// Convert the metadata of an instance to a value and back. Errors of the way back: kDataLoss.
[[nodiscard]] idf::Data metadata_to_data(const InstanceMetadata& metadata);
Result<InstanceMetadata> metadata_from_data(const idf::Data& data);

}  // namespace engram::ltm
