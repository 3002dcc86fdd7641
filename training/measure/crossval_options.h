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
  /// How each model is trained, but for its variant; its budget is that of one fold and variant.
  TrainOptions train;
  /// Trained one after the other in every fold.
  std::vector<encoders::TrainingVariant> variants{encoders::TrainingVariant::kRateAware};
  /// A query without selectors that matches one entity.
  std::string entity;
  /// A store of augmented snapshots: those that were made of what a fold trains on are trained on
  /// too, at train.augmented_share; empty: none.
  std::filesystem::path augmented;
  /// Steps of refining the latents that are measured (latent_refinement.h).
  int refine_steps = 0;
  /// Latents are measured alone and, beside that, with residuals where an image's PSNR is less
  /// than this (Representation::kCorrected); 0: alone only. Unit: dB.
  double bound_db = 0;
  /// Snapshots that are measured lie so far apart; those between them, as recordings of the same
  /// rate, are trained on as well. Zero: every one is measured.
  Duration every{};
  /// Snapshots ahead that predictions are measured for: next, over-next, ... 2 to 100.
  size_t ahead = 2;
  /// Recordings that are left out, one after another, by their number from 1 on; none: all.
  std::vector<size_t> folds;

  [[nodiscard]] Status validate() const;
  /// How images are kept that are measured: as latents alone, or corrected.
  [[nodiscard]] RepresentationOptions representation(bool is_corrected) const;
};

/// Predictions are measured at least for next and over-next.
inline constexpr size_t kMinAhead = 2;
/// A rollout is not meant to go on further.
inline constexpr size_t kMaxAhead = 100;

}  // namespace engram::training
