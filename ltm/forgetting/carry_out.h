// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>

#include "ltm/forgetting/erasure.h"
#include "ltm/forgetting/fade_report.h"

namespace engram::ltm {

/// The result of forgetting.
struct ForgetReport {
  RewriteReport rewritten;              ///< Over all rounds.
  FadeReport faded;                     ///< The same of fading.
  std::optional<ErasureReport> erased;  ///< If it was to erase.
  uint64_t rounds = 0;                  ///< Number of plans that were carried out.
  uint64_t bytes_before = 0;            ///< Bytes of the store's directory before.
  uint64_t bytes_after = 0;             ///< The same after; a live writer adds to them.
  uint64_t missing_bytes = 0;           ///< Bytes that a quota still demands.
};

/// Makes the next plan towards a quota, from the present state of the store. With `may_fade` false
/// nothing fades any more, because the round before showed that nothing is to be gained.
using PlanAgain = std::function<Result<ForgetPlan>(bool may_fade)>;

/// What forgetting needs of the rooms that learn. Each may be empty.
struct ForgetTools {
  Fade fade;
  CodeAnew code_anew;  ///< If it is there, what is forgotten is erased.
};

/// Carries out a plan: forgets first, then lets fade what stays. Plans are estimates: if a quota
/// demands more afterwards, `plan_again` makes further plans until one takes nothing more. Without
/// `plan_again` there is one round.
///
/// A kill at any moment loses nothing that was to stay. A stop takes effect between two segments.
/// It is an error if a segment of the plan was replaced in the meantime; the call may be repeated.
/// Errors and threading: those of forget_snapshots, of `tools` and of `plan_again`;
/// kFailedPrecondition if something is to fade and `tools` has no `fade`, or if it is to erase and
/// another process learns from the store or erases from it (night_lock.h).
Result<ForgetReport> carry_out(const std::filesystem::path& store, ForgetPlan plan,
                               const PlanAgain& plan_again, const ProgressSink& progress = {},
                               const std::stop_token& stop = {}, const ForgetTools& tools = {});

}  // namespace engram::ltm
