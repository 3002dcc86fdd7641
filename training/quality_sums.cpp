// SPDX-License-Identifier: Apache-2.0
#include "training/quality_sums.h"

namespace engram::training {

void QualitySums::add(const ltm::MeasuredError& error) {
  psnr.add(error.image_mse);
  rmse.add(error.number_mse);
}

void QualitySums::add(const QualitySums& more) {
  psnr.add(more.psnr);
  rmse.add(more.rmse);
}

Quality QualitySums::quality() const {
  constexpr double kLowShare = 0.05;
  return {psnr.count(),     psnr.capped(),     psnr.mean_db(),
          psnr.pooled_db(), psnr.minimum_db(), psnr.quantile_db(kLowShare),
          rmse.count(),     rmse.rmse()};
}

}  // namespace engram::training
