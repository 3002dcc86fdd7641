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

/// What one round did.
struct Round {
  RewriteReport rewritten;
  FadeReport faded;

  [[nodiscard]] bool is_cancelled() const { return rewritten.is_cancelled || faded.is_cancelled; }
};

Result<Round> carry_out_round(const std::filesystem::path& store, const ForgetPlan& plan,
                              const Fade& fade, const ProgressSink& progress,
                              const std::stop_token& stop, const ForgetRewriteOptions& options) {
  Round round;
  if (plan.snapshots() > 0) {
    ENGRAM_ASSIGN_OR_RETURN(round.rewritten,
                            forget_snapshots(store, plan.to_set(), progress, stop, options));
  }
  if (plan.fading() == 0 || round.rewritten.is_cancelled) return round;
  if (!fade)
    return failed_precondition("{} snapshots are to fade, which needs models", plan.fading());
  ENGRAM_ASSIGN_OR_RETURN(round.faded, fade(store, plan.to_fade(), progress, stop));
  return round;
}

}  // namespace

Result<ForgetReport> carry_out(const std::filesystem::path& store, ForgetPlan plan,
                               const PlanAgain& plan_again, const ProgressSink& progress,
                               const std::stop_token& stop, const ForgetRewriteOptions& options,
                               const Fade& fade) {
  ForgetReport report;
  ENGRAM_ASSIGN_OR_RETURN(report.bytes_before, directory_bytes(store));
  while (plan.snapshots() + plan.fading() > 0) {
    ENGRAM_ASSIGN_OR_RETURN(const Round round,
                            carry_out_round(store, plan, fade, progress, stop, options));
    add(round.rewritten, report.rewritten);
    report.faded.add(round.faded);
    ++report.rounds;
    // If a round did nothing, because others were faster or nothing was to be gained, the next one
    // would do nothing either, unless it takes what this one wanted to let fade.
    const bool has_faded = round.faded.settled() > 0;
    const bool may_go_on = has_faded || round.rewritten.snapshots > 0 || plan.fades_for_quota;
    if (!plan_again || round.is_cancelled() || !may_go_on) break;
    ENGRAM_ASSIGN_OR_RETURN(plan, plan_again(has_faded));
  }
  report.missing_bytes = plan.missing_bytes;
  ENGRAM_ASSIGN_OR_RETURN(report.bytes_after, directory_bytes(store));
  return report;
}

}  // namespace engram::ltm
