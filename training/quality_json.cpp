// SPDX-License-Identifier: Apache-2.0
#include "training/quality_json.h"

#include <cmath>

namespace engram::training {

nlohmann::ordered_json number_json(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json();
}

nlohmann::ordered_json quality_json(const Quality& quality) {
  return {{"images", quality.images},
          {"capped", quality.capped},
          {"mean_psnr_db", number_json(quality.mean_psnr_db)},
          {"pooled_psnr_db", number_json(quality.pooled_psnr_db)},
          {"minimum_psnr_db", number_json(quality.minimum_psnr_db)},
          {"low_psnr_db", number_json(quality.low_psnr_db)},
          {"numbers", quality.numbers},
          {"rmse", number_json(quality.rmse)}};
}

}  // namespace engram::training
