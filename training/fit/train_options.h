// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "encoders/training_variant.h"
#include "ltm/core/status.h"
#include "ltm/core/time.h"

namespace engram::training {

/// How one model is trained. Written into the model file.
struct TrainOptions {
  /// Time for one model. More is better, by about 1 dB per doubling at first.
  Duration budget = std::chrono::minutes(2);
  /// A fixed number of optimiser steps instead of the budget: same seed, same model.
  std::optional<int> steps;
  uint64_t seed = 1;
  int batch_size = 8;
  /// What the latents of images are trained for. Others than kRateAware are there to compare with.
  encoders::TrainingVariant variant = encoders::TrainingVariant::kRateAware;
  /// Quality of images to aim at: mean of their PSNR, at the fewest bytes. Figures are in
  /// docs/learning.md, section "Measured".
  double psnr_db = 36;
  /// Largest error of a number, in its unit, and of an orientation in rad; 0 keeps every bit. Not
  /// given: 0.005 standard deviations of each, and 0.001 rad.
  std::optional<double> number_bound;
  /// Without, images get no latents and no prediction but copies.
  bool has_networks = true;
  /// Features of the networks where places are few, a multiple of 16; zero chooses by the number of
  /// snapshots, because the model is stored too. consolidate() chooses by what networks may save.
  int width = 0;
  /// Channels of an image's latents at 16 x 16 and at 8 x 8 pixels.
  int coarse_channels = 24;
  int fine_channels = 8;
  /// Snapshots of a chain, each coded from those before: more take fewer bytes, one is reached
  /// later.
  int chain_rows = 16;
  /// Share of training on images as another view would show them (view_change.h), where there is
  /// more than one scene: more carries over better to new places, less knows old ones better.
  double varied_share = 0.1;
  /// Share of training on augmented values, where there are any.
  double augmented_share = 0.5;
  /// Threads of the networks. Whether two processes of one thread are quicker: parallel_speed.h.
  int threads = 2;
  /// Most bytes of decoded values to hold; beyond it evenly spaced snapshots are used.
  uint64_t memory_bytes = uint64_t{2} << 30;
  /// So many of the last recordings take no part in training.
  int hold_out_recordings = 0;

  [[nodiscard]] Status validate() const;
};

}  // namespace engram::training
