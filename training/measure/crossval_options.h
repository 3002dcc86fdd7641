// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "encoders/training_variant.h"
#include "ltm/core/status.h"
#include "ltm/core/time.h"
#include "training/fit/train_options.h"
#include "training/forms/representation.h"

namespace engram::training {

struct CrossvalOptions {
  /// Options of training each model, except its variant. The budget is for one fold and variant.
  TrainOptions train;
  /// Variants that are trained in every fold.
  std::vector<encoders::TrainingVariant> variants{encoders::TrainingVariant::kRateAware};
  /// A query without selectors that matches one entity.
  std::string entity;
  /// A store of augmented snapshots. Those made of a fold's training data are trained on too, at
  /// train.augmented_share. Empty for none.
  std::filesystem::path augmented;
  /// Steps of refinement of the measured latents (latent_refinement.h).
  int refine_steps = 0;
  /// Latents are measured alone and also with residuals for images with a PSNR below this bound
  /// (Representation::kCorrected); 0 for latents alone. Unit: dB.
  double bound_db = 0;
  /// Time between measured snapshots. The snapshots in between are trained on too, as recordings of
  /// the same rate. Zero to measure every one.
  Duration spacing{};
  /// Max horizon of measured predictions, in snapshots: 2 to 100. All horizons from 1 on are
  /// measured.
  size_t max_horizon = 2;
  /// Numbers of the recordings that are left out in turn, from 1 on; empty for all.
  std::vector<size_t> folds;

  [[nodiscard]] Status validate() const;
  /// Options of the representation of measured images: latents alone, or corrected.
  [[nodiscard]] RepresentationOptions representation(bool is_corrected) const;
};

/// Min value of CrossvalOptions::max_horizon: the next two snapshots.
inline constexpr size_t kMinHorizon = 2;
/// Max value of CrossvalOptions::max_horizon. Rollouts are not meant to be longer.
inline constexpr size_t kMaxHorizon = 100;

}  // namespace engram::training
