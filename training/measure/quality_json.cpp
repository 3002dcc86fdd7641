// SPDX-License-Identifier: Apache-2.0
#include "training/measure/quality_json.h"

#include <fmt/format.h>

#include <cmath>

#include "ltm/memory/result.h"

namespace engram::training {

nlohmann::ordered_json number_json(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json();
}

nlohmann::ordered_json quality_json(const Quality& quality) {
  nlohmann::ordered_json json{{"images", quality.images},
                              {"capped", quality.capped},
                              {"mean_psnr_db", number_json(quality.mean_psnr_db)},
                              {"pooled_psnr_db", number_json(quality.pooled_psnr_db)},
                              {"minimum_psnr_db", number_json(quality.minimum_psnr_db)},
                              {"low_psnr_db", number_json(quality.low_psnr_db)},
                              {"numbers", quality.numbers},
                              {"rmse", number_json(quality.rmse)}};
  if (!std::isnan(quality.mean_ssim)) json["mean_ssim"] = quality.mean_ssim;
  return json;
}

nlohmann::ordered_json bound_coverage_json(const BoundCoverage& bound_coverage) {
  const auto coverage_json = [](const Coverage& coverage, const char* unit) {
    return nlohmann::ordered_json{
        {"predictions", coverage.predictions},
        {"within", coverage.within},
        {"share", number_json(coverage.share())},
        {fmt::format("mean_bound_{}", unit), number_json(coverage.mean_bound)},
        {fmt::format("expected_{}", unit), number_json(coverage.expected)},
        {"mean_width_db", number_json(coverage.width_db)},
        {"vacuous", coverage.vacuous}};
  };
  return {{"probability", ltm::kBoundProbability},
          {"images", coverage_json(bound_coverage.images, "db")},
          {"numbers", coverage_json(bound_coverage.numbers, "rmse")}};
}

}  // namespace engram::training
