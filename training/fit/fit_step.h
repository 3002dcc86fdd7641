// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>

// Internal to the learning rooms.

namespace engram::training {

/// The progress of a fit at one step.
struct FitStep {
  int64_t step = 0;
  double loss = 0;     ///< Smoothed.
  double psnr_db = 0;  ///< Mean over images, smoothed; 0 without images.
  double bytes = 0;    ///< Of the latents of a value, estimated by the prior, smoothed.
  double price = 0;    ///< Of a squared grey level, in kilobytes.
};

/// Called after every step.
using StepSink = std::function<void(const FitStep&)>;

}  // namespace engram::training
