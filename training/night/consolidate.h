// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "encoders/provenance.h"
#include "ltm/memory/memory_id.h"
#include "training/fit/trainer.h"
#include "training/forms/representation.h"
#include "training/night/consolidate_plan.h"
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

/// What became of one entity.
struct EntityReport {
  ltm::MemoryId entity;
  std::string skipped_reason;  ///< Empty where latents were published, or could stay as they are.
  int model_version = 0;       ///< Whose latents were published.
  bool is_model_new = false;   ///< Else it is the one that was there, and `training` is discarded.
  uint64_t snapshots = 0;      ///< Recorded ones that got latents of that model.
  uint64_t left_behind = 0;    ///< Recorded ones of another layout: they stay as they are.
  uint64_t raw_bytes = 0;      ///< Of the encoded snapshots, plain.
  uint64_t stored_bytes = 0;   ///< Of the recorded form of the entity.
  uint64_t latent_bytes = 0;   ///< Codes and remainders, without the segment around them.
  uint64_t model_bytes = 0;
  double mean_psnr_db = 0;  ///< NaN without images, like the next three.
  double pooled_psnr_db = 0;
  double minimum_psnr_db = 0;
  /// That 5 %, half and 95 % of the images are below.
  std::array<double, 3> psnr_quantiles_db{};
  double rmse = 0;                 ///< NaN without numbers.
  encoders::StoredForms forms;     ///< How the images were kept.
  encoders::ModelChoice choice;    ///< Between the new model and the one before it.
  std::vector<std::string> notes;  ///< Why, in sentences.
  double seconds = 0;
  double encoding_seconds = 0;           ///< Of `seconds`: encoding, decoding and comparing.
  double expected_encoding_seconds = 0;  ///< As measured on a sample; 0 where it was not.
  TrainReport training;
};

struct ConsolidateReport {
  std::vector<EntityReport> entities;  ///< In the order of their names.
};

/// Told what will be done, before anything is trained.
using PlanSink = std::function<void(const ConsolidatePlan&)>;

/// What consolidate() would do, without doing it. Reads what was recorded, writes nothing.
/// Errors: those of consolidate before it trains.
Result<ConsolidatePlan> plan_consolidation(const std::filesystem::path& store,
                                           const ConsolidateOptions& options,
                                           const std::stop_token& stop);

/// The offline phase: trains a model per entity, encodes the entity's recorded snapshots with it,
/// measures what comes back from the stored bytes, and publishes model and latents together.
///
/// An entity that cannot be a tensor is skipped with its reason. Entities are published one by
/// one; a kill at any moment leaves the store with whole ones, and training goes on from its last
/// checkpoint when the job is run again. Runs beside a live writer.
/// Errors: kInvalidArgument; kNotFound where no entity matches; kCancelled on `stop`; those of the
/// store.
/// Threading: one at a time per process (train_model).
Result<ConsolidateReport> consolidate(const std::filesystem::path& store,
                                      const ConsolidateOptions& options,
                                      const ProgressSink& progress, const std::stop_token& stop,
                                      const PlanSink& plan = {});

}  // namespace engram::training
