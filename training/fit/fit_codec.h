// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "training/fit/dataset.h"
#include "training/fit/latent_table.h"
#include "training/fit/train_options.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// Learns what latents and numbers are coded with, from what will be coded.
/// Errors: kInvalidArgument where the numbers cannot be coded.
Status fit_codec(encoders::DeepModel& model, const Dataset& data, const LatentTable& latents,
                 const TrainOptions& options);

}  // namespace engram::training
