// SPDX-License-Identifier: Apache-2.0
#include "training/night/entity_report.h"

namespace engram::training {

EntityReport report_of(const PlannedEntity& planned) {
  EntityReport report;
  report.entity = planned.plan.entity;
  report.left_behind = planned.left_behind;
  report.stored_bytes = planned.plan.stored_bytes;
  return report;
}

void tell(const EncodedEntity& encoded, size_t wanted, EntityReport& report) {
  const KeptQuality& quality = encoded.quality;
  report.model_version = encoded.model_version;
  report.snapshots = quality.snapshots;
  report.waiting = wanted - encoded.snapshots;
  report.raw_bytes = quality.raw_bytes;
  report.latent_bytes = quality.latent_bytes;
  report.mean_psnr_db = quality.mean_psnr_db;
  report.pooled_psnr_db = quality.pooled_psnr_db;
  report.minimum_psnr_db = quality.minimum_psnr_db;
  report.psnr_quantiles_db = quality.psnr_quantiles_db;
  report.rmse = quality.rmse;
  report.forms = quality.forms;
}

}  // namespace engram::training
