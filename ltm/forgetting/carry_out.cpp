// SPDX-License-Identifier: Apache-2.0
#include "ltm/forgetting/carry_out.h"

#include "ltm/forgetting/plan_forgetting.h"

namespace engram::ltm {

namespace {

void add(const RewriteReport& round, RewriteReport& sum) {
  sum.segments_before += round.segments_before;
  sum.segments_after += round.segments_after;
  sum.bytes_before += round.bytes_before;
  sum.bytes_after += round.bytes_after;
  sum.snapshots += round.snapshots;
  sum.is_cancelled = sum.is_cancelled || round.is_cancelled;
}

}  // namespace

Result<ForgetReport> carry_out(const std::filesystem::path& store, ForgetPlan plan,
                               const PlanAgain& plan_again, const ProgressSink& progress,
                               const std::stop_token& stop, const ForgetRewriteOptions& options) {
  ForgetReport report;
  ENGRAM_ASSIGN_OR_RETURN(report.bytes_before, directory_bytes(store));
  while (plan.snapshots() > 0) {
    ENGRAM_ASSIGN_OR_RETURN(const RewriteReport round,
                            forget_snapshots(store, plan.to_set(), progress, stop, options));
    add(round, report.rewritten);
    ++report.rounds;
    // If a round took nothing, because others were faster, the next one would take nothing either.
    if (!plan_again || round.is_cancelled || round.snapshots == 0) break;
    ENGRAM_ASSIGN_OR_RETURN(plan, plan_again());
  }
  report.missing_bytes = plan.missing_bytes;
  ENGRAM_ASSIGN_OR_RETURN(report.bytes_after, directory_bytes(store));
  return report;
}

}  // namespace engram::ltm
