// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/progress_line.h"
#include "training/night/consolidate_plan.h"

namespace engram::cli {

/// Splits entities between two processes of one thread each. Returns nothing if one process with
/// more threads is as fast, as measured now, or if fewer than two entities will be trained.
[[nodiscard]] std::vector<std::vector<ltm::MemoryId>> split_by_measurement(
    const training::ConsolidatePlan& plan);

/// Like split_by_measurement(), without measuring.
[[nodiscard]] std::vector<std::vector<ltm::MemoryId>> split_jobs(
    const training::ConsolidatePlan& plan);

/// The option that marks a child of run_jobs(), beside its parent's options.
inline constexpr const char* kPartOption = "--part";
/// When the whole job began, in nanoseconds, so that its parts are one night in the store.
inline constexpr const char* kBeganOption = "--began";

/// Consolidates each group of entities in a process of its own, prints their reports, and returns
/// the worst of their exit codes. `arguments` follow the name of the command.
ExitCode run_jobs(const training::ConsolidatePlan& plan,
                  const std::vector<std::vector<ltm::MemoryId>>& groups,
                  const std::vector<std::string>& arguments, ProgressForm form, bool is_json);

}  // namespace engram::cli
