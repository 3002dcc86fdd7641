// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace engram::training {

/// Quality over many snapshots. Members are NaN if there was nothing to measure.
struct Quality {
  uint64_t images = 0;        ///< Values with images.
  uint64_t capped = 0;        ///< Values whose PSNR was capped at 60 dB.
  double mean_psnr_db = 0;    ///< Mean of the values' PSNR.
  double pooled_psnr_db = 0;  ///< PSNR of the pooled squared error.
  double minimum_psnr_db = 0;
  double low_psnr_db = 0;  ///< 5 % of the values are below.
  uint64_t numbers = 0;    ///< Values with numbers.
  double rmse = 0;
  double mean_ssim = 0;  ///< Of 8-bit images; measured in cross-validation only.
};

/// How the real errors of one kind compare with the predicted bounds and errors. Members are NaN if
/// nothing was predicted.
struct Coverage {
  uint64_t predictions = 0;  ///< Predictions with a bound.
  uint64_t within = 0;       ///< Those whose real error was within the bound.
  /// Mean of the bounds. Unit: dB for images, a root mean square for numbers.
  double mean_bound = 0;
  double expected = 0;  ///< Mean of the expected squared errors, in the same unit.
  /// Mean of 10 log10(bound / expected squared error): how far bounds lie from what is expected. A
  /// share near 90 % is worth little where bounds are wide.
  double width_db = 0;
  /// Bounds of images that no image could exceed (0 dB). They are within and say nothing.
  uint64_t vacuous = 0;

  [[nodiscard]] double share() const;  ///< Share within the bound; NaN without bounds.
};

struct BoundCoverage {
  Coverage images, numbers;
};

}  // namespace engram::training
