// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <set>
#include <vector>

#include "ltm/memory/segment_types.h"
#include "ltm/store/finding.h"
#include "ltm/store/packed_snapshot.h"

namespace engram::ltm {

/// Collects the links in typed values and reports those that lead to entities that do not exist.
///
/// Threading: one thread.
class LinkCheck {
 public:
  void add_entity(const MemoryId& entity) { entities_.insert(entity); }

  /// Collects the MemoryLink members of a snapshot. `types` are the types that its values were
  /// declared with.
  void add(const PackedSnapshot& snapshot, const SegmentTypes& types, const std::string& file);

  [[nodiscard]] const std::set<MemoryId>& entities() const { return entities_; }

  /// One note for each entity that is linked to but not known.
  [[nodiscard]] std::vector<Finding> findings() const;

 private:
  struct Place {
    std::string file;
    std::string snapshot;  ///< The first snapshot with such a link.
    uint64_t links = 0;
  };

  std::set<MemoryId> entities_;
  std::map<MemoryId, Place> targets_;
};

}  // namespace engram::ltm
