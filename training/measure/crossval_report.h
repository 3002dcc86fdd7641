// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "encoders/training_variant.h"
#include "ltm/core/time.h"
#include "ltm/memory/memory_id.h"
#include "training/measure/baselines.h"
#include "training/measure/prediction_quality.h"

namespace engram::training {

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
  std::vector<Quality> prediction;            ///< Of the left-out recording, by snapshots ahead.
  std::vector<BoundCoverage> bound_coverage;  ///< Of these predictions.
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

/// NaN becomes null.
[[nodiscard]] nlohmann::ordered_json to_json(const CrossvalReport& report);

}  // namespace engram::training
