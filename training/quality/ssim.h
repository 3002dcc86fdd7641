// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/idf/ndarray.h"

namespace engram::training {

/// Structural similarity of two images, 1 where they are equal: mean over all places of a Gaussian
/// window of 11 x 11 (sigma 1.5) that lies wholly inside, and over the channels.
/// Shape: uint8 [H, W, C], both alike, H and W at least 11.
/// Errors: kInvalidArgument where they are not.
/// Source: Wang et al., "Image Quality Assessment: From Error Visibility to Structural Similarity",
/// 2004, equation 13 with K1 = 0.01, K2 = 0.03.
Result<double> ssim(const idf::NdArray& recorded, const idf::NdArray& other);

}  // namespace engram::training
