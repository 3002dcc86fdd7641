// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>

// Internal to the learning rooms.

namespace engram::training {

/// How a fit is going.
struct FitStep {
  int64_t step = 0;
  double loss = 0;     ///< Smoothed.
  double psnr_db = 0;  ///< Mean over images, smoothed; 0 where there are none.
  double bytes = 0;    ///< Of the latents of a value, as the prior tells, smoothed.
  double price = 0;    ///< Of a squared grey level, in kilobytes.
};

/// Told after every step.
using StepSink = std::function<void(const FitStep&)>;

}  // namespace engram::training
