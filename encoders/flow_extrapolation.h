// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ltm/core/status.h"
#include "ltm/idf/ndarray.h"

// Private to this room.

namespace engram::encoders {

/// Extrapolates the images at 1..`steps` steps after `last`: dense optical flow from `before` to
/// `last` carries each pixel of `last` forward. If several pixels arrive at one place, faster ones
/// get a larger weight; if none arrives, the pixel of `last` stays. Nothing is learned. The learned
/// motion starts from this result, and predictions are compared with it.
///
/// Shape: uint8 or uint16, [H, W] or [H, W, 1 to 4]; both images and the results have the same type
/// and shape.
/// Errors: kInvalidArgument if type or shape is another one; kUnavailable if OpenCV fails.
/// Source: Kroeger et al., Fast Optical Flow using Dense Inverse Search.
Result<std::vector<idf::NdArray>> flow_extrapolated(const idf::NdArray& before,
                                                    const idf::NdArray& last, int steps);

}  // namespace engram::encoders
