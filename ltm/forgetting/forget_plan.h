// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "ltm/store/rewrite.h"

namespace engram::ltm {

/// What would go of one entity.
struct EntityForgetPlan {
  TimeSet gone;
  /// How many of them for which reason; each counts once.
  std::map<std::string, uint64_t> reasons;
  uint64_t freed_bytes = 0;  ///< An estimate, see ForgetPlan::freed_bytes.
  uint64_t stays = 0;        ///< Snapshots that stay.
  uint64_t unsealed = 0;     ///< Of these, in a journal: not sealed yet, so left alone.
  /// Of these, that a rule or an explicit choice took and a protection kept: linked ones, and
  /// explicit ones of protected entities. What a rule never saw is not counted.
  uint64_t shielded = 0;
};

/// What a store is to forget: a value, made without changing anything.
struct ForgetPlan {
  std::map<MemoryId, EntityForgetPlan> entities;  ///< All of the store, also those that stay whole.
  /// Snapshots are taken to be of equal size within their segment and entity; a file that goes
  /// whole counts exactly, and images in groups not before all of their entity in the segment go.
  uint64_t freed_bytes = 0;
  uint64_t store_bytes = 0;      ///< Of the store's directory, before.
  uint64_t free_disk_bytes = 0;  ///< Before.
  /// What a quota demands beyond this plan, by a careful estimate: protection is in the way.
  uint64_t missing_bytes = 0;

  [[nodiscard]] uint64_t snapshots() const;
  [[nodiscard]] uint64_t unsealed() const;
  /// What forget_snapshots takes.
  [[nodiscard]] ForgetSet to_set() const;
};

}  // namespace engram::ltm
