// SPDX-License-Identifier: Apache-2.0
#include "training/night/record_night.h"

#include <cmath>

#include "ltm/core/log.h"

namespace engram::training {

namespace {

std::optional<double> known(double psnr_db) {
  return std::isnan(psnr_db) ? std::nullopt : std::optional(psnr_db);
}

void tell_night(const EntityPlan& planned, const EntityReport& report, ltm::NightEntity& entity) {
  entity.skipped = report.skipped_reason;
  if (!report.skipped_reason.empty()) {
    entity.waiting = planned.new_snapshots;
    return;
  }
  if (report.is_model_new) entity.learned = report.training.used_snapshots;
  entity.encoded = report.snapshots;
  entity.waiting = report.waiting;
  // Numbers alone have none.
  if (report.snapshots == 0) return;
  entity.psnr_db = known(report.mean_psnr_db);
  entity.min_psnr_db = known(report.minimum_psnr_db);
}

}  // namespace

void record_night(ltm::NightAccount account, const ConsolidatePlan& plan,
                  const ConsolidateReport& report, const Status& ended) {
  for (size_t i = 0; i < plan.entities.size() && i < report.entities.size(); ++i) {
    const EntityPlan& planned = plan.entities[i];
    const EntityReport& one = report.entities[i];
    // Of a job that ended early, those that it did not come to have no name in the report.
    if (planned.skipped_reason.empty() && one.entity == planned.entity)
      tell_night(planned, one, account.of(planned.entity));
  }
  if (const Status written = account.write(system_now(), ended); !written.ok())
    log::warning("what this night did is not written down: {}", written.message());
}

}  // namespace engram::training
