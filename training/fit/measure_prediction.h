// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "training/fit/dataset.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// Chooses the shares of the ways to predict on every other held-out window, and measures their
/// errors on the windows in between. Shares are kept only if they improve on a copy of the last
/// value in mean squared error and, for images, in mean PSNR. Copies are measured on all windows.
void measure_prediction(encoders::DeepModel& model, const Dataset& data);

}  // namespace engram::training
