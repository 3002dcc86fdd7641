// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
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

/// What is known of a snapshot.
enum class RowState : uint8_t {
  kKnown,    ///< Its parts.
  kDamaged,  ///< A night looked at it and could not read it. It has no parts.
  kStale,    ///< Its parts are to be calculated anew, because others were erased. It has none.
};

/// One snapshot.
struct SaliencyRow {
  StoredParts parts{};
  /// How many snapshots it stands for: itself, and those that were forgotten between it and the
  /// next one that stays. A share that is to stay is one of these.
  uint32_t stands_for = 1;
  RowState state = RowState::kKnown;

  friend bool operator==(const SaliencyRow&, const SaliencyRow&) = default;
};

/// The rows of all snapshots of one entity in one segment.
struct EntitySaliency {
  MemoryId entity;
  std::vector<Time> times;        ///< N, increasing.
  std::vector<SaliencyRow> rows;  ///< [N]

  void append(Time time, const SaliencyRow& row) {
    times.push_back(time);
    rows.push_back(row);
  }
  /// Appends all of `other`.
  void append(const EntitySaliency& other);
  /// Those of which the parts are known.
  [[nodiscard]] EntitySaliency known_rows() const;
  /// The row of a moment, as an index; nothing if there is none. Complexity: O(log N).
  [[nodiscard]] std::optional<size_t> find(Time time) const;
};

/// What the index "saliency" of a segment holds.
using SegmentSaliency = std::vector<EntitySaliency>;

/// The kinds of the indexes (segment_index.h).
inline constexpr const char* kSaliencyIndex = "saliency";
inline constexpr const char* kWeightsIndex = "weights";

/// The entity whose index "weights" has the weights of the whole store. It has no snapshots.
[[nodiscard]] MemoryId weights_entity();

[[nodiscard]] std::vector<std::byte> pack_saliency(const SegmentSaliency& saliency);
/// Reads what pack_saliency() of this or an earlier version wrote; safe on hostile bytes. Errors:
/// kDataLoss.
Result<SegmentSaliency> unpack_saliency(std::span<const std::byte> bytes);

[[nodiscard]] std::vector<std::byte> pack_weights(const SaliencyWeights& weights);
/// Reads what pack_weights() wrote; safe on hostile bytes. Errors: kDataLoss.
Result<SaliencyWeights> unpack_weights(std::span<const std::byte> bytes);

}  // namespace engram::ltm
