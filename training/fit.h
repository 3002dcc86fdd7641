// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "training/dataset.h"

// Internal to the room: includes LibTorch.

namespace engram::training {

/// How far a fit is, asked once per step: it ends by time or by number of steps.
///
/// Threading: one thread.
class Schedule {
 public:
  /// Ends after `steps` where given, else after `seconds`.
  Schedule(std::optional<int> steps, double seconds);

  /// The share that is done, 0 to 1.
  [[nodiscard]] double share(int64_t step) const;
  [[nodiscard]] double seconds_left(int64_t step) const;

 private:
  std::optional<int> steps_;
  double seconds_;
  std::chrono::steady_clock::time_point start_;
};

/// Learning rate relative to its peak: rises for a start, then falls as a cosine to zero.
[[nodiscard]] double learning_rate_share(double share);

/// Told after every step.
using StepSink = std::function<void(int64_t step, double loss, double seconds_left)>;

struct FitResult {
  int64_t steps = 0;
  double loss = 0;  ///< Mean over the last tenth or so.
};

/// Sets the normaliser, starts from the Karhunen-Loeve transform and trains the autoencoder.
/// Errors: kCancelled.
Result<FitResult> fit_autoencoder(encoders::DeepModel& model, const Dataset& data,
                                  const TrainOptions& options, const Schedule& schedule,
                                  const std::stop_token& stop, const StepSink& sink);

/// Indices of snapshots in the middle of a window: one before and one after are of the same
/// sequence.
struct Windows {
  std::vector<int64_t> training;  ///< The next snapshot lies in the first 85 % of the sequence.
  std::vector<int64_t> held_out;  ///< It lies in the last 15 %.
};

/// Shape: `row` indexes the dataset; rows up to `row + horizon` are of the same sequence.
[[nodiscard]] Windows make_windows(std::span<const Sequence> sequences, int horizon);

/// The first row of a sequence that the dynamics are not trained on.
[[nodiscard]] size_t held_out_from(const Sequence& sequence);

/// Trains the dynamics; the autoencoder stays as it is.
/// Errors: kCancelled.
Result<FitResult> fit_dynamics(encoders::DeepModel& model, const Dataset& data,
                               const TrainOptions& options, const Schedule& schedule,
                               const std::stop_token& stop, const StepSink& sink);

/// Measures every gate on the held-out windows and keeps those that win over copying the last
/// value, in mean squared error and (images) in mean PSNR.
Status measure_prediction(encoders::DeepModel& model, const Dataset& data);

/// Integer latents of one row.
[[nodiscard]] std::vector<int32_t> latents_of(encoders::DeepModel& model, const Dataset& data,
                                              size_t row);

}  // namespace engram::training
