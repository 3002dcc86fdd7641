// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <stop_token>
#include <string>
#include <vector>

#include "ltm/core/progress.h"
#include "ltm/memory/memory_id.h"
#include "training/fit/trainer.h"
#include "training/forms/representation.h"
#include "training/measure/baselines.h"
#include "training/measure/evaluate.h"

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
inline constexpr size_t kLeastAhead = 2;
/// A rollout is not meant to go on further.
inline constexpr size_t kMostAhead = 100;

/// How well global codes find what looks alike, asked for snapshots of the left-out recording among
/// all others.
struct SimilarityQuality {
  uint64_t snapshots = 0;  ///< That were asked for; 0 where there is nothing to measure.
  uint64_t others = 0;     ///< That were looked through for each.
  /// What the nearest by code is by pixels: 1 is the nearest of all. By chance: half of `others`.
  double mean_rank = 0;
  double neighbour_share = 0;        ///< The nearest by code is the one before or after.
  double pixel_neighbour_share = 0;  ///< The nearest by pixels is.
};

/// How recordings are given back by what is stored of them.
struct Reconstruction {
  Quality trained;           ///< Of the recordings that the model was trained on.
  Quality left_out;          ///< Of the one that was left out.
  double trained_bytes = 0;  ///< Of a snapshot, in blocks.
  double left_out_bytes = 0;

  /// How much better images are that were trained on. Unit: dB, of means.
  [[nodiscard]] double gap_db() const { return trained.mean_psnr_db - left_out.mean_psnr_db; }
};

/// What the models of one training variant are worth.
struct VariantQuality {
  encoders::TrainingVariant variant{};
  Reconstruction latents;    ///< Alone.
  Reconstruction corrected;  ///< With residuals where they miss the bound that was asked for.
  uint64_t model_bytes = 0;
  std::vector<Quality> prediction;   ///< Of the left-out recording, by snapshots ahead.
  std::vector<Foresight> foresight;  ///< Of these predictions.
  /// The same, told what came of the condition as if it had been planned; nothing is measured
  /// without a condition.
  std::vector<Quality> planned;
  SimilarityQuality similarity;
};

/// One recording that was left out.
struct CrossvalFold {
  Time first{};            ///< Of the recording; not set in the mean.
  uint64_t snapshots = 0;  ///< Of it.
  /// Predictions of it, by Baseline and snapshots ahead.
  std::array<std::vector<Quality>, kBaselines> baselines;
  std::vector<VariantQuality> variants;  ///< As in the options.

  /// How much better a variant predicts images than a copy of the last. Unit: dB, of means.
  [[nodiscard]] double gain_db(size_t variant, size_t ahead) const;
};

struct CrossvalReport {
  ltm::MemoryId entity;
  double bound_db = 0;  ///< As in the options.
  std::vector<CrossvalFold> folds;
  CrossvalFold all;  ///< Over the snapshots of all folds; bytes are means of the folds.
};

/// Called with what a fold gave as soon as it is known, and the number of its recording.
using FoldSink = std::function<void(const CrossvalFold& fold, size_t number)>;

/// Trains models on all recordings of an entity but one, for each of them, and measures them on the
/// one that was left out. Nothing is published.
/// Errors: kInvalidArgument where there are fewer than two recordings, or not one that is asked
/// for; kNotFound; kCancelled; those of the store and of training. Threading: one at a time per
/// process (train_model).
Result<CrossvalReport> crossval(const std::filesystem::path& store, const CrossvalOptions& options,
                                const ProgressSink& progress = {}, const std::stop_token& stop = {},
                                const FoldSink& on_fold = {});

/// NaN becomes null.
[[nodiscard]] nlohmann::ordered_json to_json(const CrossvalReport& report);

}  // namespace engram::training
