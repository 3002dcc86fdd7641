// SPDX-License-Identifier: Apache-2.0
#include "training/measure/crossval_sums.h"

#include <cmath>

namespace engram::training {

void ReconstructionSums::add(const ReconstructionSums& fold, size_t folds) {
  trained.add(fold.trained);
  left_out.add(fold.left_out);
  trained_bytes += fold.trained_bytes / static_cast<double>(folds);
  left_out_bytes += fold.left_out_bytes / static_cast<double>(folds);
}

Reconstruction ReconstructionSums::quality() const {
  return {trained.quality(), left_out.quality(), trained_bytes, left_out_bytes};
}

void VariantSums::add(const VariantSums& fold, size_t folds) {
  latents.add(fold.latents, folds);
  corrected.add(fold.corrected, folds);
  for (size_t ahead = 0; ahead < prediction.size(); ++ahead) {
    prediction[ahead].add(fold.prediction[ahead]);
    planned[ahead].add(fold.planned[ahead]);
  }
  model_bytes += fold.model_bytes / static_cast<double>(folds);
  similarity.add(fold.similarity);
}

VariantQuality VariantSums::quality(encoders::TrainingVariant variant) const {
  VariantQuality quality;
  quality.variant = variant;
  quality.latents = latents.quality();
  quality.corrected = corrected.quality();
  for (size_t ahead = 0; ahead < prediction.size(); ++ahead) {
    quality.prediction.push_back(prediction[ahead].quality.quality());
    quality.bound_coverage.push_back(prediction[ahead].bound_coverage());
    quality.planned.push_back(planned[ahead].quality.quality());
  }
  quality.model_bytes = static_cast<uint64_t>(std::lround(model_bytes));
  quality.similarity = similarity.quality();
  return quality;
}

void FoldSums::add(const FoldSums& fold, size_t folds) {
  snapshots += fold.snapshots;
  for (size_t way = 0; way < kBaselines; ++way)
    for (size_t ahead = 0; ahead < baselines[way].size(); ++ahead)
      baselines[way][ahead].add(fold.baselines[way][ahead]);
  for (size_t i = 0; i < variants.size(); ++i) variants[i].add(fold.variants[i], folds);
}

CrossvalFold FoldSums::fold(const std::vector<encoders::TrainingVariant>& names) const {
  CrossvalFold result;
  result.snapshots = snapshots;
  for (size_t way = 0; way < kBaselines; ++way)
    for (const PredictionSums& ahead : baselines[way])
      result.baselines[way].push_back(ahead.quality.quality());
  for (size_t i = 0; i < variants.size(); ++i)
    result.variants.push_back(variants[i].quality(names[i]));
  return result;
}

}  // namespace engram::training
