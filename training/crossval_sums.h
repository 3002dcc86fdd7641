// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "training/crossval.h"
#include "training/quality_sums.h"
#include "training/similarity.h"

// Private to this room.

namespace engram::training {

/// What is added up of one variant, over one fold or over all.
struct VariantSums {
  QualitySums trained, left_out;
  std::array<PredictionSums, kAhead> prediction;
  std::array<PredictionSums, kAhead> planned;  ///< Told the conditions that came.
  /// Means of the folds: those of one fold are added, divided by the number of folds.
  double trained_bytes = 0, left_out_bytes = 0, model_bytes = 0;
  SimilaritySums similarity;

  void add(const VariantSums& fold, size_t folds);
  [[nodiscard]] VariantQuality quality(encoders::TrainingVariant variant) const;
};

/// What is added up of one fold, or of all.
struct FoldSums {
  uint64_t snapshots = 0;
  std::array<std::array<PredictionSums, kAhead>, kBaselines> baselines;
  std::vector<VariantSums> variants;

  explicit FoldSums(size_t variant_count) : variants(variant_count) {}
  void add(const FoldSums& fold, size_t folds);
  [[nodiscard]] CrossvalFold fold(const std::vector<encoders::TrainingVariant>& names) const;
};

}  // namespace engram::training
