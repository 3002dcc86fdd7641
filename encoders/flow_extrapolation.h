// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ltm/core/status.h"
#include "ltm/idf/ndarray.h"

// Private to this room.

namespace engram::encoders {

/// The images 1..`steps` steps after `last`, each pixel moving on as it did since `before`: dense
/// optical flow, pixels of `last` carried forward. Where several arrive the quicker ones count
/// more; where none does, `last` stays. Learns nothing: where learned motion starts from, and what
/// predictions are compared with.
///
/// Shape: uint8 or uint16, [H, W] or [H, W, 1 to 4], both alike, as are those returned.
/// Errors: kInvalidArgument where they are not; kUnavailable where OpenCV fails.
/// Source: Kroeger et al., Fast Optical Flow using Dense Inverse Search.
Result<std::vector<idf::NdArray>> flow_extrapolated(const idf::NdArray& before,
                                                    const idf::NdArray& last, int steps);

}  // namespace engram::encoders
