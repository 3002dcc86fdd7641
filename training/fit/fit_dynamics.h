// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "training/fit/dataset.h"
#include "training/fit/fit_loop.h"
#include "training/fit/latent_table.h"
#include "training/fit/train_options.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// Trains the dynamics to predict values, with the autoencoder frozen.
/// Errors: the errors of the loop.
Result<FitStep> fit_dynamics(encoders::DeepModel& model, const Dataset& data,
                             const LatentTable& latents, const TrainOptions& options,
                             FitLoop& loop);

}  // namespace engram::training
