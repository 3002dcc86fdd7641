// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <ctime>

#include "training/fit/dataset.h"
#include "training/fit/fit_loop.h"
#include "training/fit/train_options.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// How quick a fit was in this process.
struct FitSpeed {
  int64_t images = 0;               ///< Of all batches, those that are only a past not.
  std::clock_t processor_time = 0;  ///< Of steps, all threads together.

  /// Zero where nothing was done.
  [[nodiscard]] double images_per_second() const {
    if (processor_time <= 0) return 0;
    return static_cast<double>(images) * CLOCKS_PER_SEC / static_cast<double>(processor_time);
  }
};

/// Trains the autoencoder and the prior of its latents together: fewest bits at the PSNR that was
/// asked for. Adds to `speed`. Does nothing without images.
/// The prior learns nothing from the held-out parts of sequences (held_out_from).
/// Errors: those of the loop.
Result<FitStep> fit_autoencoder(encoders::DeepModel& model, const Dataset& data,
                                const TrainOptions& options, FitLoop& loop, FitSpeed& speed);

}  // namespace engram::training
