// SPDX-License-Identifier: Apache-2.0
#include "encoders/error_calibration.h"

#include <cmath>

namespace engram::encoders {

double ErrorCalibration::scale(double change) const {
  return std::pow(change + min_change, exponent);
}

double ErrorCalibration::expected(double change) const {
  return std::isnan(change) ? mean : expected_per_scale * scale(change);
}

double ErrorCalibration::bound(double change) const {
  return bound_per_scale * scale(change);
}

Status ErrorCalibration::validate() const {
  const bool has_scale = min_change > 0 && std::isfinite(min_change) && exponent >= 0 &&
                         exponent <= 1 && measured >= 0;
  if (!has_scale)
    return data_loss("found errors of {} predictions by (change + {}) ^ {}", measured, min_change,
                     exponent);
  for (const double error : {expected_per_scale, bound_per_scale, mean})
    if (error < 0 || std::isinf(error))
      return data_loss("found a mean squared error of {}, needs one of at least 0", error);
  return {};
}

}  // namespace engram::encoders
