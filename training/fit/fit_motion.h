// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "training/fit/dataset.h"
#include "training/fit/fit_loop.h"
#include "training/fit/train_options.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// Trains the networks of motion (ImageMotion and the features of conditions) with everything else
/// frozen. It does nothing without networks.
/// Errors: kCancelled.
Result<FitStep> fit_motion(encoders::DeepModel& model, const Dataset& data,
                           const TrainOptions& options, FitLoop& loop);

}  // namespace engram::training
