// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "ltm/memory/memory_id.h"
#include "ltm/saliency/saliency.h"

namespace engram::ltm {

/// The parts of a snapshot as they are kept: all but the reads, which are counted when it is asked.
/// 65535 stands for 1.
using StoredParts = std::array<uint16_t, kSaliencyParts - 1>;

[[nodiscard]] StoredParts stored_parts(const SaliencyParts& parts);
/// The parts of a snapshot that was read so often.
[[nodiscard]] SaliencyParts parts_of(const StoredParts& stored, uint64_t reads);

/// The parts of all snapshots of one entity in one segment.
struct EntitySaliency {
  MemoryId entity;
  std::vector<Time> times;         ///< N, increasing.
  std::vector<StoredParts> parts;  ///< [N]
};

/// What the index "saliency" of a segment holds.
using SegmentSaliency = std::vector<EntitySaliency>;

/// The kinds of the indexes (segment_index.h).
inline constexpr const char* kSaliencyIndex = "saliency";
inline constexpr const char* kWeightsIndex = "weights";

/// The entity whose index "weights" has the weights of the whole store. It has no snapshots.
[[nodiscard]] MemoryId weights_entity();

[[nodiscard]] std::vector<std::byte> pack_saliency(const SegmentSaliency& saliency);
/// Reads what pack_saliency() wrote; safe on hostile bytes. Errors: kDataLoss.
Result<SegmentSaliency> unpack_saliency(std::span<const std::byte> bytes);

[[nodiscard]] std::vector<std::byte> pack_weights(const SaliencyWeights& weights);
/// Reads what pack_weights() wrote; safe on hostile bytes. Errors: kDataLoss.
Result<SaliencyWeights> unpack_weights(std::span<const std::byte> bytes);

}  // namespace engram::ltm
