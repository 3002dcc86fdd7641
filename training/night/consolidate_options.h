// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "ltm/core/status.h"
#include "training/fit/train_options.h"
#include "training/forms/representation.h"
#include "training/night/job_control.h"

namespace engram::training {

/// Options of the offline phase.
struct ConsolidateOptions {
  /// Options of training. The budget is for all entities together and is divided by the square root
  /// of their plain bytes.
  TrainOptions train;
  /// The form of images. In the automatic one train.psnr_db follows from the bound.
  RepresentationOptions representation;
  /// Queries without selectors ("Vision/.*"); an entity is taken if any of them matches. If there
  /// are none, every entity is taken.
  std::vector<std::string> entities;
  /// A store of augmented snapshots that are trained on too, at train.augmented_share; empty for
  /// none.
  std::filesystem::path augmented;
  /// Entities with fewer recorded snapshots are skipped, because a model would cost more than it
  /// saves.
  size_t min_snapshots = 16;
  /// Whether to train even if every recorded snapshot has latents already.
  bool force = false;
  /// Whether to encode with the newest model of each entity instead of training one: the snapshots
  /// without latents, or all with `force`.
  bool reuses_models = false;
  /// Whether training starts anew instead of from the newest model of each entity.
  bool starts_anew = false;
  /// The image of any moment is decoded within about this time, which decides how many snapshots
  /// are coded from one another; zero for train.chain_rows of them.
  Duration access = std::chrono::milliseconds(50);
  JobControl job;

  [[nodiscard]] Status validate() const;
};

}  // namespace engram::training
