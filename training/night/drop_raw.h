// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <limits>
#include <optional>
#include <stop_token>

#include "ltm/core/progress.h"
#include "ltm/store/rewrite.h"

namespace engram::training {

class JobPace;

struct DropOptions {
  /// Snapshots whose reconstructed images are worse than this stay recorded. Unit: dB.
  double min_psnr_db = 0;
  /// Snapshots whose reconstructed numbers are worse than this stay recorded. Unit: theirs.
  double max_rmse = std::numeric_limits<double>::infinity();
  /// Snapshots of this moment and later stay recorded, whatever their latents: a period of grace
  /// in which a mistake can be noticed.
  std::optional<Time> stays_from;
};

/// Drops the recorded form of an entity's sealed snapshots, each only after its latent was decoded
/// as a query would, compared, and found within the bounds and as good as when it was published.
/// With `pace`, which tells progress then, it waits before each of them while the robot is busy.
/// Errors: kNotFound; kDataLoss where a latent does not decode: then nothing is dropped;
/// kCancelled; those of JobPace::pause and of drop_recorded.
Result<ltm::DropReport> drop_raw(const std::filesystem::path& store, const ltm::MemoryId& entity,
                                 const DropOptions& options, const ProgressSink& progress,
                                 const std::stop_token& stop, JobPace* pace = nullptr);

}  // namespace engram::training
