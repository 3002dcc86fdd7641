// SPDX-License-Identifier: Apache-2.0
#include "ltm/forgetting/carry_out.h"

#include <algorithm>

#include "ltm/core/log.h"
#include "ltm/forgetting/plan_forgetting.h"
#include "ltm/saliency/pending_saliency.h"
#include "ltm/store/night_lock.h"
#include "ltm/store/night_records.h"

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
  Erasures erased;

  [[nodiscard]] bool is_cancelled() const { return rewritten.is_cancelled || faded.is_cancelled; }
};

Result<Round> rewrite_segments(const std::filesystem::path& store, const ForgetPlan& plan,
                               const ForgetTools& tools, const ProgressSink& progress,
                               const std::stop_token& stop) {
  Round round;
  if (tools.code_anew) {
    // What stays comes first: if the process is killed in between, the next run finds what is to
    // go.
    auto coded = tools.code_anew(store, plan.to_set(), progress, stop);
    round.rewritten.is_cancelled = coded.status().code() == StatusCode::kCancelled;
    if (round.rewritten.is_cancelled) return round;
    ENGRAM_RETURN_IF_ERROR(coded.status());
    round.erased = *std::move(coded);
  }
  if (plan.snapshots() > 0) {
    ENGRAM_ASSIGN_OR_RETURN(round.rewritten,
                            forget_snapshots(store, plan.to_set(), progress, stop));
  }
  if (plan.fading() == 0 || round.rewritten.is_cancelled) return round;
  if (!tools.fade)
    return failed_precondition("{} snapshots are to fade, which needs models", plan.fading());
  ENGRAM_ASSIGN_OR_RETURN(round.faded, tools.fade(store, plan.to_fade(), progress, stop));
  return round;
}

std::set<MemoryId> entities_of(const ForgetSet& gone) {
  std::set<MemoryId> entities;
  for (const auto& [entity, times] : gone) entities.insert(entity);
  return entities;
}

/// What staying snapshots are worth stays as it was, for the next round and the next run; but
/// erasing leaves nothing that was calculated beside what is erased.
Result<Round> carry_out_round(const std::filesystem::path& store, const ForgetPlan& plan,
                              const ForgetTools& tools, const ProgressSink& progress,
                              const std::stop_token& stop) {
  ENGRAM_ASSIGN_OR_RETURN(KeptSaliency kept, KeptSaliency::read(store));
  if (tools.code_anew) kept.make_stale(entities_of(plan.to_set()));
  return kept.carry_over(store,
                         [&] { return rewrite_segments(store, plan, tools, progress, stop); });
}

Status finish_erasure(const std::filesystem::path& store, ErasureReport& report) {
  ENGRAM_ASSIGN_OR_RETURN(report.files, remove_side_files(store, report.entities));
  std::set<MemoryId> erased;
  for (const auto& [entity, one] : report.entities)
    if (one.erased > 0) erased.insert(entity);
  if (!erased.empty()) ENGRAM_RETURN_IF_ERROR(make_saliency_stale(store, erased));
  return write_erasure_report(store, system_now(), report);
}

/// Adds what one round took of each entity. Of a round that was stopped in between it is not known.
void tell(const ForgetPlan& plan, const Round& round, NightAccount& account) {
  if (!round.is_cancelled())
    for (const auto& [id, times] : plan.to_set()) account.of(id).forgotten += times.size();
  for (const auto& [id, faded] : round.faded.entities) {
    if (faded.faded == 0) continue;
    NightEntity& entity = account.of(id);
    entity.faded += faded.faded;
    entity.min_psnr_db = std::min(entity.min_psnr_db.value_or(faded.certain_db), faded.certain_db);
  }
}

/// Writes down what was done until now. Forgetting does not fail for its record.
void write_down(NightAccount& account, const ForgetReport& report) {
  if (report.rewritten.snapshots == 0 && report.faded.faded() == 0) return;
  const bool is_cancelled = report.rewritten.is_cancelled || report.faded.is_cancelled;
  const Status written =
      account.write(system_now(), is_cancelled ? cancelled("stopped") : Status());
  if (!written.ok()) log::warning("what was forgotten is not written down: {}", written.message());
}

}  // namespace

Result<ForgetReport> carry_out(const std::filesystem::path& store, ForgetPlan plan,
                               const PlanAgain& plan_again, const ProgressSink& progress,
                               const std::stop_token& stop, const ForgetTools& tools) {
  ForgetReport report;
  ENGRAM_ASSIGN_OR_RETURN(report.bytes_before, directory_bytes(store));
  std::optional<NightLock> lock;
  if (tools.code_anew) {
    ENGRAM_ASSIGN_OR_RETURN(NightLock taken, NightLock::of_erasing(store));
    lock.emplace(std::move(taken));
    report.erased.emplace();
  }
  ENGRAM_ASSIGN_OR_RETURN(NightAccount account,
                          NightAccount::open(store, NightWork::kForget, system_now()));
  // What was forgotten before is looked for even if nothing goes now.
  for (bool is_first = true; (is_first && tools.code_anew) || plan.snapshots() + plan.fading() > 0;
       is_first = false) {
    ENGRAM_ASSIGN_OR_RETURN(const Round round, carry_out_round(store, plan, tools, progress, stop));
    add(round.rewritten, report.rewritten);
    if (report.erased) {
      report.erased->add(round.erased);
      for (const auto& [id, times] : plan.to_set())
        report.erased->entities[id].erased += times.size();
    }
    report.faded.add(round.faded);
    ++report.rounds;
    // Before a quota is looked at again, because the record is part of what the store takes.
    tell(plan, round, account);
    write_down(account, report);
    // If a round did nothing, because others were faster or nothing was to be gained, the next one
    // would do nothing either, unless it takes what this one wanted to let fade.
    const bool has_faded = round.faded.settled() > 0;
    const bool may_go_on = has_faded || round.rewritten.snapshots > 0 || plan.fades_for_quota;
    if (!plan_again || round.is_cancelled() || !may_go_on) break;
    ENGRAM_ASSIGN_OR_RETURN(plan, plan_again(has_faded));
  }
  report.missing_bytes = plan.missing_bytes;
  if (report.erased && !report.rewritten.is_cancelled)
    ENGRAM_RETURN_IF_ERROR(finish_erasure(store, *report.erased));
  ENGRAM_ASSIGN_OR_RETURN(report.bytes_after, directory_bytes(store));
  return report;
}

}  // namespace engram::ltm
