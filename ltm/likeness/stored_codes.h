// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "ltm/likeness/likeness_space.h"
#include "ltm/store/store_reader.h"

namespace engram::ltm {

/// The codes of one entity in one segment.
struct EntityCodes {
  MemoryId entity;
  uint64_t space = 0;         ///< LikenessSpace::id() of the space that they are of.
  std::vector<Time> times;    ///< N, increasing.
  std::vector<int8_t> codes;  ///< [N, kCodeSize]

  /// The code of a moment; empty if there is none.
  /// Complexity: O(log N).
  [[nodiscard]] std::span<const int8_t> find(Time time) const;

  void append(Time time, std::span<const int8_t> code);
};

/// What the index "codes" of a segment holds.
using SegmentCodes = std::vector<EntityCodes>;

/// The kinds of the indexes (segment_index.h).
inline constexpr const char* kCodesIndex = "codes";
inline constexpr const char* kSpaceIndex = "space";

[[nodiscard]] std::vector<std::byte> pack_codes(const SegmentCodes& codes);

/// Reads what pack_codes() wrote; safe on hostile bytes.
/// Errors: kDataLoss.
Result<SegmentCodes> unpack_codes(std::span<const std::byte> bytes);

/// The space in which codes of an entity are made; nothing if none was learned, or if it is
/// damaged.
[[nodiscard]] std::optional<LikenessSpace> read_space(const StoreReader& store,
                                                      const MemoryId& entity);

/// The codes of an entity in all segments of a generation that are of one space.
///
/// A code counts only if its segment still holds the newest form of its moment: a snapshot that was
/// recorded again has another image.
/// Threading: one thread.
class StoredCodes {
 public:
  /// Indexes that are damaged or missing count as empty.
  static StoredCodes read(StoreReader& store, const MemoryId& entity, uint64_t space);

  /// The code of a moment; empty if none is stored. Valid as long as this object.
  [[nodiscard]] std::span<const int8_t> find(const SnapshotEntry& entry) const;

  /// The same if it is stored with this segment.
  [[nodiscard]] std::span<const int8_t> find_in(uint32_t segment, Time time) const;

  /// How many a segment has.
  [[nodiscard]] size_t count_in(uint32_t segment) const;

 private:
  std::map<uint32_t, EntityCodes> by_segment_;
};

/// The segment that the code of a moment is stored with: that of its latents, which stay when the
/// recorded form goes; nothing for moments in journals.
[[nodiscard]] std::optional<uint32_t> segment_of_code(const SnapshotEntry& entry);

}  // namespace engram::ltm
