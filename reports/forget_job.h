// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "ltm/core/progress.h"
#include "ltm/forgetting/carry_out.h"
#include "ltm/forgetting/forget_options.h"

namespace engram::reports {

/// What `engram forget` does to a store, each time with its newest generation.
struct ForgetJob {
  std::string store;
  std::vector<std::string> targets;  ///< IDs and queries; empty: the policies say what goes.
  ltm::ForgetOptions options;
  ProgressSink progress;
  std::stop_token stop;

  /// Changes nothing. Errors: those of find_forget_targets and plan_forgetting.
  [[nodiscard]] Result<ltm::ForgetPlan> plan() const;

  /// Carries a plan out, and goes on towards a quota where there is one.
  /// Errors: those of ltm::carry_out.
  [[nodiscard]] Result<ltm::ForgetReport> carry_out(ltm::ForgetPlan plan) const;

 private:
  [[nodiscard]] Result<ltm::ForgetPlan> plan_with(const ltm::ForgetOptions& with) const;
};

}  // namespace engram::reports
