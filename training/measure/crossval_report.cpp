// SPDX-License-Identifier: Apache-2.0
#include "training/measure/crossval_report.h"

#include <nlohmann/json.hpp>
#include <string>

#include "training/measure/quality_json.h"

namespace engram::training {

namespace {

using Json = nlohmann::ordered_json;

Json to_json(const SimilarityQuality& similarity) {
  return {{"snapshots", similarity.snapshots},
          {"others", similarity.others},
          {"mean_rank", similarity.mean_rank},
          {"neighbour_share", similarity.neighbour_share},
          {"pixel_neighbour_share", similarity.pixel_neighbour_share}};
}

Json to_json(const Reconstruction& reconstruction) {
  return {{"trained", quality_json(reconstruction.trained)},
          {"left_out", quality_json(reconstruction.left_out)},
          {"reconstruction_gap_db", number_json(reconstruction.gap_db())},
          {"trained_bytes", reconstruction.trained_bytes},
          {"left_out_bytes", reconstruction.left_out_bytes}};
}

Json to_json(const CrossvalFold& fold) {
  Json json{{"snapshots", fold.snapshots}};
  for (size_t way = 0; way < kBaselines; ++way)
    for (const Quality& ahead : fold.baselines[way])
      json["baselines"][std::string(to_string(static_cast<Baseline>(way)))].push_back(
          quality_json(ahead));
  for (size_t i = 0; i < fold.variants.size(); ++i) {
    const VariantQuality& variant = fold.variants[i];
    Json& one = json["variants"][std::string(to_string(variant.variant))];
    one = to_json(variant.latents);
    one["model_bytes"] = variant.model_bytes;
    one["similarity"] = to_json(variant.similarity);
    if (variant.corrected.left_out_bytes > 0) one["corrected"] = to_json(variant.corrected);
    for (size_t ahead = 0; ahead < variant.prediction.size(); ++ahead) {
      one["prediction"].push_back(quality_json(variant.prediction[ahead]));
      one["planned"].push_back(quality_json(variant.planned[ahead]));
      one["bound"].push_back(bound_coverage_json(variant.bound_coverage[ahead]));
      one["gain_over_copy_last_db"].push_back(number_json(fold.gain_db(i, ahead)));
    }
  }
  return json;
}

}  // namespace

double CrossvalFold::gain_db(size_t variant, size_t ahead) const {
  return variants[variant].prediction[ahead].mean_psnr_db -
         baselines[static_cast<size_t>(Baseline::kCopyLast)][ahead].mean_psnr_db;
}

nlohmann::ordered_json to_json(const CrossvalReport& report) {
  Json folds = Json::array();
  for (const CrossvalFold& fold : report.folds) {
    folds.push_back(to_json(fold));
    folds.back()["left_out_from"] = engram::to_string(fold.first);
  }
  return {{"entity", report.entity.to_string()},
          {"bound_db", report.bound_db},
          {"folds", folds},
          {"all", to_json(report.all)}};
}

}  // namespace engram::training
