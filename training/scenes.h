// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "training/dataset.h"

// Internal to the room: includes LibTorch.

namespace engram::training {

/// Finds the backgrounds of a dataset: the median image of each recording, recordings that look
/// alike sharing one. Sets `scene` and `backgrounds`.
void find_scenes(Dataset& data);

}  // namespace engram::training
