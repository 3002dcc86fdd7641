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

/// The quality of search by global codes: for snapshots of the left-out recording, the most similar
/// one among all others is searched for.
struct SimilarityQuality {
  uint64_t snapshots = 0;  ///< Queried snapshots; 0 if there is nothing to measure.
  uint64_t others = 0;     ///< Candidates for each of them.
  /// Mean rank by pixels of the nearest snapshot by code; 1 is the nearest of all. Chance gives
  /// half of `others`.
  double mean_rank = 0;
  /// Share of queries for which the nearest by code is the snapshot before or after.
  double neighbour_share = 0;
  double pixel_neighbour_share = 0;  ///< The same for the nearest by pixels.
};

/// Quality and size of reconstructed recordings.
struct Reconstruction {
  Quality trained;           ///< Recordings that the model was trained on.
  Quality left_out;          ///< The left-out recording.
  double trained_bytes = 0;  ///< Bytes per snapshot, in blocks.
  double left_out_bytes = 0;

  /// Difference in mean PSNR between trained and left-out recordings. Unit: dB.
  [[nodiscard]] double gap_db() const { return trained.mean_psnr_db - left_out.mean_psnr_db; }
};

/// The quality of the models of one training variant.
struct VariantQuality {
  encoders::TrainingVariant variant{};
  Reconstruction latents;    ///< Latents alone.
  Reconstruction corrected;  ///< With residuals for images that miss the requested bound.
  uint64_t model_bytes = 0;
  std::vector<Quality> prediction;            ///< Of the left-out recording, per horizon.
  std::vector<BoundCoverage> bound_coverage;  ///< Of these predictions.
  /// The same with the real future of the condition as the plan. Empty without a condition.
  std::vector<Quality> planned;
  SimilarityQuality similarity;
};

/// The result of one left-out recording.
struct CrossvalFold {
  Time first{};            ///< Start of the recording; not set in the mean.
  uint64_t snapshots = 0;  ///< Snapshots of the recording.
  /// Predictions of it, by Baseline and horizon.
  std::array<std::vector<Quality>, kBaselines> baselines;
  std::vector<VariantQuality> variants;  ///< As in the options.

  /// Gain of a variant over a copy of the last image, in mean PSNR. Unit: dB.
  [[nodiscard]] double gain_db(size_t variant, size_t ahead) const;
};

struct CrossvalReport {
  ltm::MemoryId entity;
  double bound_db = 0;  ///< As in the options.
  std::vector<CrossvalFold> folds;
  CrossvalFold all;  ///< Over the snapshots of all folds; bytes are means of the folds.
};

/// Converts a report to JSON. NaN becomes null.
[[nodiscard]] nlohmann::ordered_json to_json(const CrossvalReport& report);

}  // namespace engram::training
