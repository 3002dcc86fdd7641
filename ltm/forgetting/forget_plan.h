// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "ltm/store/rewrite.h"

namespace engram::ltm {

/// The part of a plan for one entity.
struct EntityForgetPlan {
  TimeSet gone;
  /// Number of gone snapshots by reason; each snapshot counts once.
  std::map<std::string, uint64_t> reasons;
  uint64_t freed_bytes = 0;  ///< An estimate, see ForgetPlan::freed_bytes.
  uint64_t stays = 0;        ///< Snapshots that stay.
  uint64_t unsealed = 0;     ///< Staying snapshots that are in a journal, as only sealed ones go.
  /// Staying snapshots that a rule or an explicit choice took and a protection kept: linked ones,
  /// and explicitly chosen ones of protected entities. Those that no rule saw are not counted.
  uint64_t shielded = 0;
};

/// A plan of what a store is to forget. Making it changes nothing.
struct ForgetPlan {
  /// All entities of the store, also those that stay whole.
  std::map<MemoryId, EntityForgetPlan> entities;
  /// An estimate that takes all snapshots of an entity in a segment to be of equal size. A file
  /// that goes whole counts exactly. Images in groups count only if all snapshots of their entity
  /// in the segment go.
  uint64_t freed_bytes = 0;
  uint64_t store_bytes = 0;      ///< Bytes of the store's directory before.
  uint64_t free_disk_bytes = 0;  ///< Free bytes on its disk before.
  /// Bytes that a quota demands beyond this plan, by a careful estimate. Protected snapshots keep
  /// the plan from freeing them.
  uint64_t missing_bytes = 0;

  [[nodiscard]] uint64_t snapshots() const;
  [[nodiscard]] uint64_t unsealed() const;
  /// Converts the plan to the argument of forget_snapshots.
  [[nodiscard]] ForgetSet to_set() const;
};

}  // namespace engram::ltm
