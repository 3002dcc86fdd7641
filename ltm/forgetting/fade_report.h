// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <stop_token>

#include "ltm/core/progress.h"
#include "ltm/forgetting/forget_plan.h"

namespace engram::ltm {

/// What fading did to one entity.
struct EntityFadeReport {
  uint64_t faded = 0;    ///< Snapshots that faded.
  uint64_t kept = 0;     ///< Snapshots whose bytes stay, because coding them anew saves too little.
  uint64_t waiting = 0;  ///< Snapshots that are coded together with some that do not fade.
  uint64_t bytes_before = 0;  ///< Bytes of the latents of those that faded.
  uint64_t bytes_after = 0;
  /// PSNR of the worst snapshot that faded: as expected, and what it certainly has. Unit: dB.
  double expected_db = std::numeric_limits<double>::infinity();
  double certain_db = std::numeric_limits<double>::infinity();
};

struct FadeReport {
  std::map<MemoryId, EntityFadeReport> entities;
  bool is_cancelled = false;

  /// Number of snapshots that faded or of which nothing is to be gained.
  [[nodiscard]] uint64_t settled() const;
  [[nodiscard]] uint64_t faded() const;
  /// Adds what a later round did.
  void add(const FadeReport& later);
};

/// Lets snapshots fade. Forgetting gets it from above, because it needs codecs and models.
using Fade =
    std::function<Result<FadeReport>(const std::filesystem::path& store, const FadeSet& what,
                                     const ProgressSink& progress, const std::stop_token& stop)>;

}  // namespace engram::ltm
