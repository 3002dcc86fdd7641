// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "ltm/store/rewrite.h"

namespace engram::ltm {

/// Snapshots of one entity that fade equally far.
struct FadingSnapshots {
  /// Min PSNR of every image against what was recorded; a gist where there is none. Unit: dB.
  std::optional<double> psnr_db;
  TimeSet times;
};

/// What is to fade, by entity.
using FadeSet = std::map<MemoryId, std::vector<FadingSnapshots>>;

/// The part of a plan for one entity.
struct EntityForgetPlan {
  TimeSet gone;
  /// Number of gone snapshots by reason; each snapshot counts once.
  std::map<std::string, uint64_t> reasons;
  uint64_t freed_bytes = 0;  ///< An estimate, see ForgetPlan::freed_bytes.
  /// Staying snapshots that fade.
  std::vector<FadingSnapshots> fading;
  /// Number of them by reason; each snapshot counts once.
  std::map<std::string, uint64_t> fading_reasons;
  uint64_t faded_bytes = 0;  ///< An estimate of what their fading frees.
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
  /// Bytes that a quota demands beyond what this plan is expected to free. Protected snapshots keep
  /// the plan from freeing them.
  uint64_t missing_bytes = 0;

  /// What a reader may have understood otherwise, in words.
  std::vector<std::string> notes;

  /// An estimate of what fading frees beyond `freed_bytes`.
  uint64_t faded_bytes = 0;
  /// Whether some snapshots fade for a quota. How much that frees shows afterwards, so the quota
  /// takes none in this plan.
  bool fades_for_quota = false;

  /// Number of snapshots that go.
  [[nodiscard]] uint64_t snapshots() const;
  /// Number of snapshots that fade.
  [[nodiscard]] uint64_t fading() const;
  [[nodiscard]] uint64_t unsealed() const;
  /// Converts the plan to the argument of forget_snapshots.
  [[nodiscard]] ForgetSet to_set() const;
  [[nodiscard]] FadeSet to_fade() const;
};

}  // namespace engram::ltm
