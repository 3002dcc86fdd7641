// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: what a store has at the end of a link.

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "ltm/reflection/series_block.h"
#include "ltm/store/store_reader.h"

namespace engram::ltm {

/// Finds the snapshots that links lead to. The times of each entity are read once, and texts that
/// were met are kept, because many snapshots link to the same moment.
///
/// Threading: one thread. The store must outlive it.
class LinkTargets {
 public:
  explicit LinkTargets(StoreReader& store);

  /// Where a text leads. Errors: those of Timeline.
  Result<LinkTarget> find(std::string_view text);

  /// The times of all snapshots of an entity that the store has, in their order. Unit: ns.
  /// Errors: those of Timeline.
  Result<const std::vector<int64_t>*> times(const MemoryId& entity);

  /// The entity of a number in LinkTarget. Needs one that is there (checked).
  [[nodiscard]] const MemoryId& entity(int32_t number) const;

 private:
  struct TextHash {
    using is_transparent = void;
    size_t operator()(std::string_view text) const { return std::hash<std::string_view>{}(text); }
  };
  struct Known {
    MemoryId entity;
    std::vector<int64_t> times;
    bool is_read = false;
  };

  Result<LinkTarget> look_up(std::string_view text);
  Result<int32_t> number_of(const MemoryId& entity);

  StoreReader& store_;
  std::set<std::vector<std::string>> segments_;  ///< Memory and core segment, of all entities.
  std::map<MemoryId, int32_t> numbers_;
  std::vector<Known> known_;
  std::unordered_map<std::string, LinkTarget, TextHash, std::equal_to<>> texts_;
};

}  // namespace engram::ltm
