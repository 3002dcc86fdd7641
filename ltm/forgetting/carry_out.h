// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "ltm/forgetting/forget_plan.h"

namespace engram::ltm {

/// What forgetting did.
struct ForgetReport {
  RewriteReport rewritten;     ///< Over all rounds.
  uint64_t rounds = 0;         ///< Plans that were carried out.
  uint64_t bytes_before = 0;   ///< Of the store's directory.
  uint64_t bytes_after = 0;    ///< Grows beside a live writer.
  uint64_t missing_bytes = 0;  ///< That a quota still demands.
};

/// Makes the next plan towards a quota, of the store as it is now.
using PlanAgain = std::function<Result<ForgetPlan>()>;

/// Carries out a plan. Plans estimate: where a quota demands more afterwards, `plan_again` is
/// asked, until its plan takes nothing more. Without one there is one round.
///
/// Killed at any moment, all that was not to go is there; a stop comes between two segments. A
/// segment that is in a plan and was replaced meanwhile is an error, and may be tried again.
/// Errors and threading: those of forget_snapshots, which gets `options`, and of `plan_again`.
Result<ForgetReport> carry_out(const std::filesystem::path& store, ForgetPlan plan,
                               const PlanAgain& plan_again, const ProgressSink& progress = {},
                               const std::stop_token& stop = {},
                               const ForgetRewriteOptions& options = {});

}  // namespace engram::ltm
