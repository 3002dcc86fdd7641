// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <limits>

#include "ltm/recall/model.h"
#include "training/measure/prediction_quality.h"
#include "training/quality/quality_metrics.h"

// Private to this room.

namespace engram::training {

inline constexpr double kNoSsim = std::numeric_limits<double>::quiet_NaN();

/// Collects errors of both kinds.
///
/// Threading: one thread.
struct QualitySums {
  PsnrStatistics psnr;
  RmseStatistics rmse;
  double ssim_sum = 0;
  uint64_t ssim_count = 0;

  /// `ssim`: not a number is left out.
  void add(const ltm::MeasuredError& error, double ssim = kNoSsim);
  void add(const QualitySums& more);
  [[nodiscard]] Quality quality() const;
};

/// Adds up whether errors of one kind were what was told beforehand.
///
/// Threading: one thread.
class CoverageSums {
 public:
  /// What makes of a mean squared error the unit that Coverage counts in.
  using Unit = double (*)(double mse);
  explicit CoverageSums(Unit unit) : unit_(unit) {}

  /// Mean squared errors; what is not a number is left out.
  void add(double expected, double bound, double error);
  void add(const CoverageSums& more);
  [[nodiscard]] Coverage coverage() const;

 private:
  Unit unit_;
  uint64_t bounded_ = 0, within_ = 0, expected_ = 0;
  double bound_sum_ = 0;     ///< In the unit.
  double expected_sum_ = 0;  ///< Of mean squared errors.
};

/// Collects the errors of predictions, and whether they were what was told.
///
/// Threading: one thread.
struct PredictionSums {
  QualitySums quality;
  CoverageSums images{psnr_db};
  CoverageSums numbers{std::sqrt};

  void add(const ltm::ErrorEstimate& told, const ltm::MeasuredError& error, double ssim = kNoSsim);
  void add(const PredictionSums& more);
  [[nodiscard]] BoundCoverage bound_coverage() const {
    return {images.coverage(), numbers.coverage()};
  }
};

}  // namespace engram::training
