// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "ltm/core/progress.h"
#include "ltm/forgetting/carry_out.h"
#include "ltm/forgetting/forget_options.h"
#include "ltm/recall/model.h"

namespace engram::reports {

/// The work of `engram forget`. Each step uses the newest generation of the store.
struct ForgetJob {
  std::string store;
  /// IDs and queries; empty: the policies decide what is forgotten.
  std::vector<std::string> targets;
  ltm::ForgetOptions options;
  /// Opens models of what is kept as latents alone.
  ltm::ModelLoader loader;
  ProgressSink progress;
  std::stop_token stop;
  /// Lets snapshots fade, and codes anew what stays where `erases`.
  ltm::ForgetTools tools;
  /// Whether nothing of what is forgotten may be left in any file.
  bool erases = false;

  /// Plans what is to be carried out: before anything is erased, it seals what is in journals.
  /// Errors: those of plan() and of ltm::seal_before_erasing.
  [[nodiscard]] Result<ltm::ForgetPlan> final_plan() const;

  /// Plans without changing anything.
  /// Errors: those of find_forget_targets and plan_forgetting.
  [[nodiscard]] Result<ltm::ForgetPlan> plan() const;

  /// Carries out a plan, and continues towards the quota if there is one.
  /// Errors: those of ltm::carry_out.
  [[nodiscard]] Result<ltm::ForgetReport> carry_out(ltm::ForgetPlan plan) const;

 private:
  [[nodiscard]] Result<ltm::ForgetPlan> plan_with(const ltm::ForgetOptions& with) const;
};

}  // namespace engram::reports
