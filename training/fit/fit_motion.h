// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "training/fit/dataset.h"
#include "training/fit/fit_loop.h"
#include "training/fit/train_options.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// Trains what continues the motion of images; everything else stays as it is. Does nothing without
/// networks.
/// Errors: kCancelled.
Result<FitStep> fit_motion(encoders::DeepModel& model, const Dataset& data,
                           const TrainOptions& options, FitLoop& loop);

}  // namespace engram::training
