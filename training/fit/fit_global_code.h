// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "training/fit/dataset.h"
#include "training/fit/latent_table.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// Fits the model's global code to small images of the rows. It does nothing without images.
void fit_global_code(encoders::DeepModel& model, const Dataset& data, const LatentTable& latents);

}  // namespace engram::training
