// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "training/fit/dataset.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// Finds the backgrounds of a dataset: the median image of each recording, recordings that look
/// alike sharing one. Those of `start` come first, as they are; recordings that it knows share
/// them. Sets `scene`, `backgrounds` and `known_scenes`. `start` may be null.
void find_scenes(Dataset& data, const encoders::DeepModel* start);

}  // namespace engram::training
