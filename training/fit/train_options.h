// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "encoders/training_variant.h"
#include "ltm/core/status.h"
#include "ltm/core/time.h"

namespace engram::training {

/// Options of training one model. They are written into the model file.
struct TrainOptions {
  /// Time for one model. Each doubling gains about 1 dB at first.
  Duration budget = std::chrono::minutes(2);
  /// A fixed number of optimiser steps instead of the budget: same seed, same model.
  std::optional<int> steps;
  uint64_t seed = 1;
  int batch_size = 8;
  /// The loss of the latents of images. Variants other than kRateAware are for comparison.
  encoders::TrainingVariant variant = encoders::TrainingVariant::kRateAware;
  /// Target quality of images: the mean of their PSNR, at the fewest bytes. Figures are in
  /// docs/learning.md, section "Measured".
  double psnr_db = 36;
  /// Max error of a number, in its unit, and of an orientation, in rad; 0 keeps every bit. By
  /// default 0.005 standard deviations of each number, and 0.001 rad.
  std::optional<double> number_bound;
  /// Whether networks are made. Without them images get no latents, and predictions are copies.
  bool has_networks = true;
  /// Features of the networks at 1/16 of the resolution, a multiple of 16. Zero chooses by the
  /// number of snapshots, because the model is stored too; consolidate() chooses by the bytes that
  /// networks may save.
  int width = 0;
  /// Channels of the latents of an image per cell of 16 x 16 and of 8 x 8 pixels.
  int coarse_channels = 24;
  int fine_channels = 8;
  /// Snapshots of a chain, each coded from those before it. Longer chains take fewer bytes, but
  /// reading one snapshot takes longer.
  int chain_rows = 16;
  /// Share of training on changed views of images (view_change.h) if there is more than one scene.
  /// More of them generalise better to new places, fewer are better for known ones.
  double varied_share = 0.1;
  /// Share of training on augmented values, if there are any.
  double augmented_share = 0.5;
  /// Threads of the networks. parallel_speed.h measures whether two processes of one thread are
  /// faster.
  int threads = 2;
  /// Max bytes of decoded values in memory. If there are more, evenly spaced runs of snapshots take
  /// turns (RowRotation). A job that trains shall stay below 1.5 GB with all that it needs.
  uint64_t memory_bytes = uint64_t{256} << 20;
  /// Number of last recordings that are left out of training.
  int hold_out_recordings = 0;

  [[nodiscard]] Status validate() const;
};

}  // namespace engram::training
