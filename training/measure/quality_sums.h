// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <limits>

#include "encoders/error_calibration.h"
#include "ltm/recall/model.h"
#include "training/measure/prediction_quality.h"
#include "training/quality/quality_metrics.h"

// Private to this room.

namespace engram::training {

inline constexpr double kNoSsim = std::numeric_limits<double>::quiet_NaN();

/// Collects errors of images and of numbers.
///
/// Threading: one thread.
struct QualitySums {
  PsnrStatistics psnr;
  RmseStatistics rmse;
  double ssim_sum = 0;
  uint64_t ssim_count = 0;

  /// An `ssim` of NaN is left out.
  void add(const ltm::MeasuredError& error, double ssim = kNoSsim);
  void add(const QualitySums& more);
  [[nodiscard]] Quality quality() const;
};

/// Counts how the real errors of one kind compare with the predicted ones.
///
/// Threading: one thread.
class CoverageSums {
 public:
  /// Converts a mean squared error to the unit of Coverage.
  using Unit = double (*)(double mse);
  explicit CoverageSums(Unit unit, double max_mse = std::numeric_limits<double>::infinity())
      : unit_(unit), max_mse_(max_mse) {}

  /// Adds mean squared errors. NaN is left out. A bound counts as at most the largest possible
  /// error.
  void add(double expected, double bound, double error);
  void add(const CoverageSums& more);
  [[nodiscard]] Coverage coverage() const;

 private:
  Unit unit_;
  double max_mse_;  ///< The largest possible error.
  uint64_t bounded_ = 0, within_ = 0, expected_ = 0, vacuous_ = 0, widths_ = 0;
  double bound_sum_ = 0;     ///< In the unit of Coverage.
  double expected_sum_ = 0;  ///< Sum of mean squared errors.
  double width_sum_ = 0;     ///< Unit: dB.
};

/// Collects the errors of predictions and compares them with the predicted errors.
///
/// Threading: one thread.
struct PredictionSums {
  QualitySums quality;
  CoverageSums images{psnr_db, encoders::kMaxImageMse};
  CoverageSums numbers{std::sqrt};

  void add(const ltm::ErrorEstimate& told, const ltm::MeasuredError& error, double ssim = kNoSsim);
  void add(const PredictionSums& more);
  [[nodiscard]] BoundCoverage bound_coverage() const {
    return {images.coverage(), numbers.coverage()};
  }
};

}  // namespace engram::training
