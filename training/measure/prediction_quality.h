// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace engram::training {

/// Quality over many snapshots. NaN where there was nothing to measure.
struct Quality {
  uint64_t images = 0;        ///< Values with images.
  uint64_t capped = 0;        ///< Those whose PSNR was capped at 60 dB.
  double mean_psnr_db = 0;    ///< Mean of the values' PSNR.
  double pooled_psnr_db = 0;  ///< PSNR of the pooled squared error.
  double minimum_psnr_db = 0;
  double low_psnr_db = 0;  ///< 5 % of the values are below.
  uint64_t numbers = 0;    ///< Values with numbers.
  double rmse = 0;
  double mean_ssim = 0;  ///< Of images of 8 bits, where it was measured: in cross-validation.
};

/// Whether errors of one kind were what predictions had told beforehand. NaN where nothing was.
struct Coverage {
  uint64_t predictions = 0;  ///< That told a bound.
  uint64_t within = 0;       ///< Whose real error was at most that.
  /// Mean of the bounds. Unit: images dB, numbers that of a root mean square.
  double mean_bound = 0;
  double expected = 0;  ///< Mean of the squared errors that were expected, in the same unit.

  [[nodiscard]] double share() const;  ///< Of those within; NaN without any.
};

struct BoundCoverage {
  Coverage images, numbers;
};

}  // namespace engram::training
