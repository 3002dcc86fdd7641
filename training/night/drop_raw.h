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
  /// Min PSNR of reconstructed images. Snapshots with a lower one stay recorded. Unit: dB.
  double min_psnr_db = 0;
  /// Max RMSE of reconstructed numbers. Snapshots with a higher one stay recorded. Unit: that of
  /// the numbers.
  double max_rmse = std::numeric_limits<double>::infinity();
  /// Snapshots of this moment and later stay recorded, whatever their latents. This gives a grace
  /// period in which mistakes can be noticed.
  std::optional<Time> stays_from;
};

/// Drops the recorded form of an entity's sealed snapshots. Each latent is first decoded as in a
/// query and compared: it must be within the bounds and as good as when it was published. With
/// `pace`, which then reports progress, it waits before each snapshot while the robot is busy.
/// Errors: kNotFound; kDataLoss if a latent does not decode, and then nothing is dropped;
/// kCancelled; the errors of JobPace::pause and of drop_recorded.
Result<ltm::DropReport> drop_raw(const std::filesystem::path& store, const ltm::MemoryId& entity,
                                 const DropOptions& options, const ProgressSink& progress,
                                 const std::stop_token& stop, JobPace* pace = nullptr);

}  // namespace engram::training
