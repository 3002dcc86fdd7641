// SPDX-License-Identifier: Apache-2.0
#include "training/fade/fade_error.h"

#include <cmath>

namespace engram::training {

namespace {

/// The next number with 8 binary digits.
double rounded_up(double mse) {
  if (!(mse > 0) || std::isinf(mse)) return mse;
  int exponent = 0;
  const double digits = std::frexp(mse, &exponent);
  return std::ldexp(std::ceil(std::ldexp(digits, 8)), exponent - 8);
}

ltm::MeasuredError rounded_up(const ltm::MeasuredError& error) {
  return {rounded_up(error.image_mse), rounded_up(error.number_mse)};
}

double joined_mse(double before, double step, double correlation) {
  return before + step + 2 * correlation * std::sqrt(before * step);
}

ltm::MeasuredError joined_error(const ltm::MeasuredError& before, const ltm::MeasuredError& step,
                                double correlation) {
  return {joined_mse(before.image_mse, step.image_mse, correlation),
          joined_mse(before.number_mse, step.number_mse, correlation)};
}

}  // namespace

// The positive root of s^2 + 2 c b s + b^2 = t, where b, s and t are root mean squared errors
// before and of the step, and t^2 the target.
double max_step_mse(double before_mse, double target_mse) {
  if (target_mse <= before_mse) return 0;
  const double shared = kMaxErrorCorrelation * std::sqrt(before_mse);
  const double step = std::sqrt(shared * shared + target_mse - before_mse) - shared;
  return step * step;
}

ltm::LatentQuality joined_quality(const std::optional<ltm::LatentQuality>& before,
                                  const ltm::MeasuredError& step, float faded_to_db) {
  if (!before) return {rounded_up(step), {}, faded_to_db};
  return {rounded_up(joined_error(before->error, step, 0)),
          rounded_up(joined_error(before->certain(), step, 1)), faded_to_db};
}

}  // namespace engram::training
