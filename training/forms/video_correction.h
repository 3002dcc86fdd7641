// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "ltm/core/status.h"
#include "ltm/idf/ndarray.h"

namespace engram::training {

/// Residuals that bring those images of a video within a bound that miss it.
struct VideoCorrection {
  std::vector<std::byte> residual;  ///< Of all images, by encoders::ResidualEncoder.
  std::vector<double> mse;          ///< Per image, corrected. Unit: grey levels squared.
};

/// Corrects the images of a video, of which few miss `bound_db` and by little: then residuals of
/// those take fewer bytes than a better quality of all. The result is empty if no residual keeps
/// the bound, or the images are not of 8 bits.
///
/// It decodes what it coded, so `mse` is what a reader will see.
/// Shape: `images` and `decoded` uint8 [H, W, C], equally many.
/// Errors: kInvalidArgument if their shapes differ.
/// Threading: thread-safe.
/// Source: docs/learning_methods.md, sections "Residuals" and "What is stored".
Result<std::optional<VideoCorrection>> correct_video(std::span<const idf::NdArray> images,
                                                     std::span<const idf::NdArray> decoded,
                                                     double bound_db);

/// Applies stored residuals to a decoded video.
/// Errors: kDataLoss if the bytes are no residuals of so many images.
Status apply_residuals(std::span<const std::byte> residual, std::span<idf::NdArray> images);

}  // namespace engram::training
