// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "ltm/store/manifest.h"

namespace engram::ltm {

/// What the segments of a store tell of each entity.
///
/// A few entities are looked up one at a time, so that nothing depends on how many others there
/// are. From the number on where that would take longer, all are read at once.
///
/// Threading: one thread.
class EntityIndex {
 public:
  /// Its entry in each segment that names it, with the index of the segment.
  using Entries = std::vector<std::pair<uint32_t, const SegmentEntity*>>;

  EntityIndex() = default;
  explicit EntityIndex(const std::vector<SegmentInfo>& segments);

  /// Empty if no segment names it. Valid until the next call.
  [[nodiscard]] const Entries& of(const MemoryId& entity);

  /// Reads all of them. Valid as long as the index.
  [[nodiscard]] const std::map<MemoryId, Entries>& all();

  /// At least as many as there are entities, without reading them.
  [[nodiscard]] size_t max_size() const;

 private:
  std::vector<SegmentEntities> segments_;
  /// Those that were found, or all.
  std::map<MemoryId, Entries> known_;
  uint64_t cost_ = 0;   ///< Of a look into each segment.
  uint64_t spent_ = 0;  ///< On entities that were looked up one at a time.
  bool has_all_ = false;
};

/// The time of the last snapshot that segments name; empty if they have none.
[[nodiscard]] std::optional<Time> last_time_in(const EntityIndex::Entries& entries);

}  // namespace engram::ltm
