// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "encoders/torch.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::encoders {

/// Extrapolates the images at 1..`steps` steps after each `last` by optical flow from `before`
/// (flow_extrapolation.h). If no flow can be found, they are copies of `last`.
///
/// Shape: both [B, C, H, W], grey levels -> [B, steps, C, H, W], whole grey levels.
[[nodiscard]] torch::Tensor moved_on(const torch::Tensor& before, const torch::Tensor& last,
                                     int steps);

}  // namespace engram::encoders
