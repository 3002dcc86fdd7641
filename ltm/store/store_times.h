// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <list>
#include <memory>

#include "ltm/store/entity_index.h"
#include "ltm/store/entity_times.h"
#include "ltm/store/store_reader.h"

namespace engram::ltm {

/// Reads the times of entities in the generation of a store that a reader shows. It has segments
/// open of its own, so that who draws many lanes opens each of them once.
///
/// Threading: one thread.
class StoreTimes {
 public:
  /// `reader` must outlive it.
  explicit StoreTimes(StoreReader& reader);

  /// Errors: kNotFound naming the entity; kDataLoss; kUnavailable if a consolidation replaced a
  /// segment meanwhile: open the store again then.
  /// Complexity: the time column of each segment is read as a whole.
  Result<EntityTimes> of(const MemoryId& entity);

 private:
  Result<SegmentReader*> open(uint32_t segment);

  StoreReader& reader_;
  EntityIndex index_;
  /// Used last first.
  std::list<std::pair<uint32_t, std::unique_ptr<SegmentReader>>> open_;
};

}  // namespace engram::ltm
