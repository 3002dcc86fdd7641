// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/idf/ndarray.h"

namespace engram::training {

/// Structural similarity of two images; 1 if they are equal. It is the mean over all positions at
/// which a Gaussian window of 11 x 11 (sigma 1.5) lies inside the image, and over the channels.
/// Shape: uint8 [H, W, C], equal for both, H and W at least 11.
/// Errors: kInvalidArgument if type or shape is another one.
/// Source: Wang et al., "Image Quality Assessment: From Error Visibility to Structural Similarity",
/// 2004, equation 13 with K1 = 0.01, K2 = 0.03.
Result<double> ssim(const idf::NdArray& recorded, const idf::NdArray& other);

}  // namespace engram::training
