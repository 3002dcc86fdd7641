// SPDX-License-Identifier: Apache-2.0
#include "training/fit/conformal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "ltm/core/check.h"
#include "ltm/memory/result.h"

namespace engram::training {

using encoders::ErrorCalibration;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr std::array<double, 5> kExponents{0.0, 0.25, 0.5, 0.75, 1.0};
/// Min bound in comparisons of bounds, relative to the min change. The logarithm of zero would be
/// infinite.
constexpr double kMinBound = 1e-6;

double bound_per_scale(const ErrorCalibration& by, std::span<const MeasuredPrediction> measured) {
  std::vector<double> scores;
  for (const MeasuredPrediction& one : measured) scores.push_back(one.error / by.scale(one.change));
  return conformal_quantile(std::move(scores), ltm::kBoundProbability);
}

double error_per_scale(const ErrorCalibration& by, std::span<const MeasuredPrediction> measured) {
  double errors = 0, scales = 0;
  for (const MeasuredPrediction& one : measured) {
    errors += one.error;
    scales += by.scale(one.change);
  }
  return errors / scales;
}

/// Mean logarithm of the bounds of measured predictions.
double mean_width(ErrorCalibration by, std::span<const MeasuredPrediction> measured) {
  by.bound_per_scale = bound_per_scale(by, measured);
  double sum = 0;
  for (const MeasuredPrediction& one : measured)
    sum += std::log(std::max(by.bound(one.change), kMinBound * by.min_change));
  return sum / static_cast<double>(measured.size());
}

double best_exponent(ErrorCalibration by, std::span<const MeasuredPrediction> measured) {
  double best = 0;
  double min = std::numeric_limits<double>::infinity();
  for (const double exponent : kExponents) {
    by.exponent = exponent;
    if (std::isnan(bound_per_scale(by, measured))) return 0;
    const double width = mean_width(by, measured);
    if (width >= min) continue;
    min = width;
    best = exponent;
  }
  return best;
}

}  // namespace

double conformal_quantile(std::vector<double> scores, double probability) {
  ENGRAM_CHECK(probability > 0 && probability < 1, "found a probability of {}", probability);
  // Rounding must not raise the product above a whole number.
  constexpr double kRounding = 1e-9;
  const auto rank = static_cast<size_t>(
      std::ceil(static_cast<double>(scores.size() + 1) * probability - kRounding));
  if (rank > scores.size()) return kNaN;
  const auto at = scores.begin() + static_cast<ptrdiff_t>(std::max<size_t>(rank, 1) - 1);
  std::ranges::nth_element(scores, at);
  return *at;
}

ErrorCalibration calibrate(std::span<const MeasuredPrediction> choosing,
                           std::span<const MeasuredPrediction> calibrating, double min_change) {
  ErrorCalibration by;
  by.min_change = min_change;
  by.exponent = best_exponent(by, choosing);
  by.bound_per_scale = bound_per_scale(by, calibrating);
  const auto measured = calibrating.empty() ? choosing : calibrating;
  if (measured.empty()) return by;
  double errors = 0;
  for (const MeasuredPrediction& one : measured) errors += one.error;
  by.measured = static_cast<int64_t>(measured.size());
  by.mean = errors / static_cast<double>(measured.size());
  by.expected_per_scale = error_per_scale(by, measured);
  return by;
}

void widen(ErrorCalibration& by, std::span<const MeasuredPrediction> all,
           std::span<const MeasuredPrediction> held_out) {
  const auto ratio = [](double more, double less) {
    return less > 0 && std::isfinite(more) ? std::max(1.0, more / less) : 1.0;
  };
  by.bound_per_scale *= ratio(bound_per_scale(by, all), bound_per_scale(by, held_out));
  by.expected_per_scale *= ratio(error_per_scale(by, all), error_per_scale(by, held_out));
}

}  // namespace engram::training
