// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "training/fit/dataset.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// Measures the shares of every way to predict on every other held-out window and keeps those that
/// win over copying the last value, in mean squared error and (images) in mean PSNR; on the others,
/// how wrong these are. Copies are measured on all windows.
void measure_prediction(encoders::DeepModel& model, const Dataset& data);

}  // namespace engram::training
