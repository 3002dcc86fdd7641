// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/progress_line.h"
#include "training/night/consolidate_plan.h"

namespace engram::cli {

/// Entities for two processes of one thread each; none where one process with more threads is as
/// quick, by what is measured now, or where fewer than two entities will be trained.
[[nodiscard]] std::vector<std::vector<ltm::MemoryId>> split_by_measurement(
    const training::ConsolidatePlan& plan);

/// The same without measuring.
[[nodiscard]] std::vector<std::vector<ltm::MemoryId>> split_jobs(
    const training::ConsolidatePlan& plan);

/// The options that a command was given, but for some, as arguments for a child.
[[nodiscard]] std::vector<std::string> arguments_of(const CLI::App& command,
                                                    const std::vector<std::string>& but);

/// What a child of run_jobs() is called with, beside what its parent was.
inline constexpr const char* kPartOption = "--part";

/// Consolidates each group of entities in a process of its own, prints what they report, and
/// returns the worst of their exit codes. `arguments` follow the name of the command.
ExitCode run_jobs(const training::ConsolidatePlan& plan,
                  const std::vector<std::vector<ltm::MemoryId>>& groups,
                  const std::vector<std::string>& arguments, ProgressForm form, bool is_json);

}  // namespace engram::cli
