// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <ctime>

#include "training/fit/dataset.h"
#include "training/fit/fit_loop.h"
#include "training/fit/train_options.h"
#include "training/fit/training_source.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// Speed of a fit in this process.
struct FitSpeed {
  int64_t images = 0;               ///< Images of all batches, without those that are only a past.
  std::clock_t processor_time = 0;  ///< Processor time of all steps and threads.

  /// Zero if there were no steps.
  [[nodiscard]] double images_per_second() const {
    if (processor_time <= 0) return 0;
    return static_cast<double>(images) * CLOCKS_PER_SEC / static_cast<double>(processor_time);
  }
};

/// Trains the autoencoder and the prior of its latents together, for the fewest bits at the
/// requested PSNR. It adds to `speed`, and does nothing without images. The prior does not learn
/// from the held-out parts of sequences (held_out_from).
/// Rows that are not in memory take the places of others in `data` (RowRotation).
/// Errors: the errors of the loop and of the source.
Result<FitStep> fit_autoencoder(encoders::DeepModel& model, const TrainingSource& source,
                                Dataset& data, const TrainOptions& options, FitLoop& loop,
                                FitSpeed& speed);

}  // namespace engram::training
