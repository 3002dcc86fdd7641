// SPDX-License-Identifier: Apache-2.0
#include "training/measure/quality_sums.h"

#include <algorithm>

namespace engram::training {

void QualitySums::add(const ltm::MeasuredError& error, double ssim) {
  psnr.add(error.image_mse);
  rmse.add(error.number_mse);
  if (std::isnan(ssim)) return;
  ssim_sum += ssim;
  ++ssim_count;
}

void QualitySums::add(const QualitySums& more) {
  psnr.add(more.psnr);
  rmse.add(more.rmse);
  ssim_sum += more.ssim_sum;
  ssim_count += more.ssim_count;
}

// Without any SSIM its mean is 0 / 0, which is NaN.
Quality QualitySums::quality() const {
  constexpr double kLowShare = 0.05;
  return {psnr.count(),     psnr.capped(),     psnr.mean_db(),
          psnr.pooled_db(), psnr.minimum_db(), psnr.quantile_db(kLowShare),
          rmse.count(),     rmse.rmse(),       ssim_sum / static_cast<double>(ssim_count)};
}

double Coverage::share() const {
  return static_cast<double>(within) / static_cast<double>(predictions);
}

void CoverageSums::add(double expected, double bound, double error) {
  if (std::isnan(error)) return;
  if (!std::isnan(expected)) {
    ++expected_;
    expected_sum_ += expected;
  }
  if (std::isnan(bound)) return;
  ++bounded_;
  within_ += error <= bound ? 1 : 0;
  vacuous_ += bound >= max_mse_ ? 1 : 0;
  const double capped = std::min(bound, max_mse_);
  bound_sum_ += unit_(capped);
  // Where nothing is known to change, both are 0 and there is no width.
  const double width_db = 10 * std::log10(capped / expected);
  if (!std::isfinite(width_db)) return;
  ++widths_;
  width_sum_ += width_db;
}

void CoverageSums::add(const CoverageSums& more) {
  bounded_ += more.bounded_;
  within_ += more.within_;
  expected_ += more.expected_;
  vacuous_ += more.vacuous_;
  widths_ += more.widths_;
  width_sum_ += more.width_sum_;
  bound_sum_ += more.bound_sum_;
  expected_sum_ += more.expected_sum_;
}

// Without predictions all means are 0 / 0, which is NaN.
Coverage CoverageSums::coverage() const {
  return {bounded_,
          within_,
          bound_sum_ / static_cast<double>(bounded_),
          unit_(expected_sum_ / static_cast<double>(expected_)),
          width_sum_ / static_cast<double>(widths_),
          vacuous_};
}

void PredictionSums::add(const ltm::ErrorEstimate& told, const ltm::MeasuredError& error,
                         double ssim) {
  quality.add(error, ssim);
  images.add(told.expected.image_mse, told.bound.image_mse, error.image_mse);
  numbers.add(told.expected.number_mse, told.bound.number_mse, error.number_mse);
}

void PredictionSums::add(const PredictionSums& more) {
  quality.add(more.quality);
  images.add(more.images);
  numbers.add(more.numbers);
}

}  // namespace engram::training
