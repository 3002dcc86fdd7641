// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "training/fit/dataset.h"
#include "training/fit/latent_table.h"
#include "training/fit/train_options.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// Trains the codecs of latents and numbers on the values that will be coded.
/// Errors: kInvalidArgument if the numbers cannot be coded.
Status fit_codec(encoders::DeepModel& model, const Dataset& data, const LatentTable& latents,
                 const TrainOptions& options);

}  // namespace engram::training
