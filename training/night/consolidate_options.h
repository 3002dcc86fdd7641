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

/// What the offline phase works on.
struct ConsolidateOptions {
  /// Its budget is that of all entities together, split by the square root of their plain bytes.
  TrainOptions train;
  /// In what form images are kept. In the automatic one train.psnr_db follows its bound.
  RepresentationOptions representation;
  /// Queries without selectors ("Vision/.*"); an entity that any of them matches is taken. Empty:
  /// every entity.
  std::vector<std::string> entities;
  /// A store of augmented snapshots that are trained on too, at train.augmented_share; empty: none.
  std::filesystem::path augmented;
  /// Entities with fewer recorded snapshots are skipped: a model would cost more than it saves.
  size_t min_snapshots = 16;
  /// Also trains where every recorded snapshot has latents already.
  bool force = false;
  /// Encodes with the newest model of each entity instead of training one: what has no latents yet,
  /// or all with `force`.
  bool reuses_models = false;
  /// Training does not start from the newest model of each entity.
  bool starts_anew = false;
  JobControl job;

  [[nodiscard]] Status validate() const;
};

}  // namespace engram::training
