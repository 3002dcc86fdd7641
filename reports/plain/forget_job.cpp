// SPDX-License-Identifier: Apache-2.0
#include "reports/plain/forget_job.h"

#include "ltm/core/log.h"
#include "ltm/forgetting/plan_forgetting.h"

namespace engram::reports {

Result<ltm::ForgetPlan> ForgetJob::plan() const {
  return plan_with(options);
}

Result<ltm::ForgetPlan> ForgetJob::plan_with(const ltm::ForgetOptions& with) const {
  ENGRAM_ASSIGN_OR_RETURN(auto reader, ltm::StoreReader::open(store));
  ENGRAM_ASSIGN_OR_RETURN(ltm::ForgetContext context, ltm::ForgetContext::of(store));
  context.progress = progress;
  context.stop = stop;
  const ltm::AccessTable accesses = ltm::read_accesses(store);
  ltm::Recall recall(std::move(reader), loader);
  ltm::ForgetSource source(recall, accesses);
  if (targets.empty()) return ltm::plan_forgetting(source, with, context);
  ENGRAM_ASSIGN_OR_RETURN(const auto chosen, ltm::find_forget_targets(recall, targets));
  return ltm::plan_forgetting_of(source, chosen, with.protection, context);
}

Result<ltm::ForgetReport> ForgetJob::carry_out(ltm::ForgetPlan plan) const {
  ltm::PlanAgain again;
  if (targets.empty() && (options.max_bytes || options.min_free_disk_bytes))
    again = [this, quota = ltm::quota_after(options, plan)](bool may_fade) mutable {
      if (!may_fade) quota.fade.clear();
      return plan_with(quota);
    };
  const ltm::ForgetSet gone = plan.to_set();
  auto report = ltm::carry_out(store, std::move(plan), again, progress, stop, {}, fade);
  // Access logs of forgotten snapshots are useless, but failing to clear them does no harm.
  if (report.ok() && !report->rewritten.is_cancelled)
    if (const Status status = ltm::merge_accesses(store, gone); !status.ok())
      log::warning("access logs stay as they are: {}", status.message());
  return report;
}

}  // namespace engram::reports
