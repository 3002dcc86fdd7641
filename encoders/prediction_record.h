// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "encoders/error_calibration.h"
#include "ltm/core/time.h"
#include "ltm/recall/model.h"

namespace engram::encoders {

/// Horizons that a model's gates and errors are measured for.
inline constexpr int kMeasuredHorizons = 5;

/// How wrong predictions of one horizon are.
struct HorizonErrors {
  ErrorCalibration images, numbers;
};

/// How well a model predicts, per horizon from 1 on.
struct PredictionRecord {
  /// Shares of what latents and of what motion expects; the rest is the last value: both zero are
  /// copy-last.
  std::array<double, kMeasuredHorizons> image_gates{};
  std::array<double, kMeasuredHorizons> motion_gates{};
  std::array<double, kMeasuredHorizons> number_gates{};
  std::array<HorizonErrors, kMeasuredHorizons> errors{};
  Duration step{};

  /// Of a prediction so many steps ahead, where so much changed just before. Steps beyond what was
  /// measured are expected to be as wrong as the last ones that were, and have no bound.
  [[nodiscard]] ltm::ErrorEstimate estimate(const ltm::MeasuredError& change, int steps) const;

  /// Those horizons that were measured.
  [[nodiscard]] std::vector<ltm::HorizonRecord> horizons() const;
};

}  // namespace engram::encoders
