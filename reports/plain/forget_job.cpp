// SPDX-License-Identifier: Apache-2.0
#include "reports/plain/forget_job.h"

#include "ltm/core/log.h"
#include "ltm/forgetting/erasure.h"
#include "ltm/forgetting/plan_forgetting.h"
#include "ltm/forgetting/redact_store.h"

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
  ltm::StoreReader* const opened = reader.get();
  ltm::Recall recall(std::move(reader), loader);
  ltm::ForgetSource source(recall, accesses, stop);
  ltm::ForgetPlan plan;
  if (targets.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(plan, ltm::plan_forgetting(source, with, context));
  } else {
    ENGRAM_ASSIGN_OR_RETURN(const auto chosen, ltm::find_forget_targets(recall, targets));
    ENGRAM_ASSIGN_OR_RETURN(plan,
                            ltm::plan_forgetting_of(source, chosen, with.protection, context));
    plan.notes = ltm::notes_on_targets(targets);
  }
  ENGRAM_ASSIGN_OR_RETURN(const uint64_t pending, ltm::pending_redactions(store));
  if (erases && pending > 0)
    plan.notes.push_back(fmt::format(
        "a redaction was cut off, and originals of {} snapshots may still be there: the same "
        "'engram redact' takes them",
        pending));
  if (erases && plan.unsealed() > 0)
    plan.notes.push_back("what is in journals is sealed first, and goes, too, where it is meant");
  ENGRAM_RETURN_IF_ERROR(erases ? ltm::add_made_of(*opened, plan)
                                : ltm::note_what_is_left(*opened, plan));
  return plan;
}

Result<ltm::ForgetPlan> ForgetJob::final_plan() const {
  if (erases) ENGRAM_RETURN_IF_ERROR(ltm::seal_before_erasing(store));
  return plan();
}

Result<ltm::ForgetReport> ForgetJob::carry_out(ltm::ForgetPlan plan) const {
  ltm::PlanAgain again;
  if (targets.empty() && (options.max_bytes || options.min_free_disk_bytes))
    again = [this, quota = ltm::quota_after(options, plan)](bool may_fade) mutable {
      if (!may_fade) quota.fade.clear();
      return plan_with(quota);
    };
  const ltm::ForgetSet gone = plan.to_set();
  ltm::ForgetTools used = tools;
  if (!erases) used.code_anew = {};
  auto report = ltm::carry_out(store, std::move(plan), again, progress, stop, used);
  // Access logs of forgotten snapshots are useless, but failing to clear them does no harm.
  if (report.ok() && !report->rewritten.is_cancelled)
    if (const Status status = ltm::merge_accesses(store, gone); !status.ok())
      log::warning("access logs stay as they are: {}", status.message());
  return report;
}

}  // namespace engram::reports
