// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "encoders/error_calibration.h"
#include "ltm/core/time.h"
#include "ltm/recall/model.h"

namespace engram::encoders {

/// Number of horizons for which the gates and errors of a model are measured.
inline constexpr int kMeasuredHorizons = 5;

/// The errors of predictions of one horizon.
struct HorizonErrors {
  ErrorCalibration images, numbers;
};

/// The gates and measured errors of a model per horizon, from horizon 1 on.
struct PredictionRecord {
  /// Shares of the predictions by latents and by motion. The rest is the last value, so a
  /// prediction with both at zero copies it.
  std::array<double, kMeasuredHorizons> image_gates{};
  std::array<double, kMeasuredHorizons> motion_gates{};
  std::array<double, kMeasuredHorizons> number_gates{};
  std::array<HorizonErrors, kMeasuredHorizons> errors{};
  Duration step{};

  /// Estimates the error of a prediction `steps` ahead after a `change` of the last two values.
  /// Steps beyond the measured horizons get the expected error of the last measured one and no
  /// bound.
  [[nodiscard]] ltm::ErrorEstimate estimate(const ltm::MeasuredError& change, int steps) const;

  /// The horizons that were measured.
  [[nodiscard]] std::vector<ltm::HorizonRecord> horizons() const;
};

}  // namespace engram::encoders
