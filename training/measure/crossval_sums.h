// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "training/measure/crossval_report.h"
#include "training/measure/quality_sums.h"
#include "training/measure/similarity.h"

// Private to this room.

namespace engram::training {

/// Sums over reconstructions. Bytes are means of the folds, so those of one fold are divided by the
/// number of folds and added.
struct ReconstructionSums {
  QualitySums trained, left_out;
  double trained_bytes = 0, left_out_bytes = 0;

  void add(const ReconstructionSums& fold, size_t folds);
  [[nodiscard]] Reconstruction quality() const;
};

/// Sums of one variant, over one fold or over all.
struct VariantSums {
  ReconstructionSums latents, corrected;
  std::vector<PredictionSums> prediction;  ///< Per horizon.
  std::vector<PredictionSums> planned;     ///< With the real future of the conditions as plan.
  double model_bytes = 0;                  ///< Mean of the folds, as for reconstructions.
  SimilaritySums similarity;

  explicit VariantSums(size_t ahead) : prediction(ahead), planned(ahead) {}
  void add(const VariantSums& fold, size_t folds);
  [[nodiscard]] VariantQuality quality(encoders::TrainingVariant variant) const;
};

/// Sums of one fold, or of all.
struct FoldSums {
  uint64_t snapshots = 0;
  std::array<std::vector<PredictionSums>, kBaselines> baselines;
  std::vector<VariantSums> variants;

  FoldSums(size_t variant_count, size_t ahead) : variants(variant_count, VariantSums(ahead)) {
    baselines.fill(std::vector<PredictionSums>(ahead));
  }
  void add(const FoldSums& fold, size_t folds);
  [[nodiscard]] CrossvalFold fold(const std::vector<encoders::TrainingVariant>& names) const;
};

}  // namespace engram::training
