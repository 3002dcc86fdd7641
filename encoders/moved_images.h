// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "encoders/torch.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::encoders {

/// Images 1..`steps` steps after each `last`, as optical flow from `before` moves them on
/// (flow_extrapolation.h). Where no flow can be found they are copies.
///
/// Shape: both [B, C, H, W], grey levels -> [B, steps, C, H, W], whole grey levels.
[[nodiscard]] torch::Tensor moved_on(const torch::Tensor& before, const torch::Tensor& last,
                                     int steps);

}  // namespace engram::encoders
