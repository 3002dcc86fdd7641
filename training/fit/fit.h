// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ctime>

#include "training/fit/dataset.h"
#include "training/fit/fit_loop.h"

// Internal to the room: includes LibTorch.

namespace engram::training {

/// Freezes the parameters of a module as long as it lives.
class Frozen {
 public:
  explicit Frozen(torch::nn::Module& module) : parameters_(module.parameters()) { set(false); }
  ~Frozen() { set(true); }
  Frozen(const Frozen&) = delete;
  Frozen& operator=(const Frozen&) = delete;

 private:
  void set(bool is_trained) {
    for (torch::Tensor& parameter : parameters_) parameter.set_requires_grad(is_trained);
  }
  std::vector<torch::Tensor> parameters_;
};

/// The next step's are taken as they come, and what has none is left as it is; LibTorch's own
/// zero_grad fills and adds, or not, depending on its version.
inline void forget_gradients(torch::optim::Optimizer& optimiser) {
  for (auto& group : optimiser.param_groups())
    for (torch::Tensor& parameter : group.params()) parameter.mutable_grad().reset();
}

inline constexpr double kBitsOfKilobyte = 8000;

/// Elements of all images of a value, in images of 128 x 128 pixels of three channels: bits count
/// by it, as errors are means.
[[nodiscard]] double size_in_usual_images(const encoders::NetworkShape& shape);

/// How quick a fit was in this process.
struct FitSpeed {
  int64_t images = 0;               ///< Of all batches, those that are only a past not.
  std::clock_t processor_time = 0;  ///< Of steps, all threads together.

  /// Zero where nothing was done.
  [[nodiscard]] double images_per_second() const {
    if (processor_time <= 0) return 0;
    return static_cast<double>(images) * CLOCKS_PER_SEC / static_cast<double>(processor_time);
  }
};

/// Trains the autoencoder and the prior of its latents together: fewest bits at the PSNR that was
/// asked for. Adds to `speed`. Does nothing without images.
/// The prior learns nothing from the held-out parts of sequences (held_out_from).
/// Errors: those of the loop.
Result<FitStep> fit_autoencoder(encoders::DeepModel& model, const Dataset& data,
                                const TrainOptions& options, FitLoop& loop, FitSpeed& speed);

/// The rounded latents of all rows, kept as 16-bit integers.
struct LatentTable {
  std::vector<encoders::ImageLatents> images;
  torch::Tensor numbers;
  torch::Tensor scene;

  [[nodiscard]] encoders::Latents rows(const torch::Tensor& indices) const;
};

[[nodiscard]] LatentTable encode_all(encoders::DeepModel& model, const Dataset& data);

/// Learns what latents and numbers are coded with, from what will be coded.
/// Errors: kInvalidArgument where the numbers cannot be coded.
Status fit_codec(encoders::DeepModel& model, const Dataset& data, const LatentTable& latents,
                 const TrainOptions& options);

/// Fits the model's global code to small images of the rows. Does nothing without images.
void fit_global_code(encoders::DeepModel& model, const Dataset& data, const LatentTable& latents);

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

/// Trains the dynamics to predict values; the autoencoder stays as it is.
/// Errors: those of the loop.
Result<FitStep> fit_dynamics(encoders::DeepModel& model, const Dataset& data,
                             const LatentTable& latents, const TrainOptions& options,
                             FitLoop& loop);

/// Trains what continues the motion of images; everything else stays as it is. Does nothing without
/// networks.
/// Errors: kCancelled.
Result<FitStep> fit_motion(encoders::DeepModel& model, const Dataset& data,
                           const TrainOptions& options, FitLoop& loop);

/// Measures the shares of every way to predict on every other held-out window and keeps those that
/// win over copying the last value, in mean squared error and (images) in mean PSNR; on the others,
/// how wrong these are. Copies are measured on all windows.
void measure_prediction(encoders::DeepModel& model, const Dataset& data);

}  // namespace engram::training
