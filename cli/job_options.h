// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli/command.h"
#include "cli/progress_line.h"
#include "training/night/job_control.h"

namespace engram::cli {

/// The options of a job that runs for hours, unparsed.
struct JobArguments {
  std::string budget;  ///< Empty: everything is done.
  std::string until;   ///< Empty: the same.
  std::string yield_file;
  std::string checkpoint_interval = "1min";
  std::string progress = "auto";
};

/// Adds --budget and --until (beside --training and --steps, which must exist), --fresh,
/// --checkpoint-every, --yield-file, --yield-command and --progress. All arguments must outlive the
/// command.
void add_job_options(CLI::App& command, JobArguments& arguments, training::JobControl& job);

/// Parses the options that add_job_options could not write into `job` itself. A budget begins now.
/// Errors: kInvalidArgument.
Status finish_job_options(const JobArguments& arguments, training::JobControl& job);

/// The form of progress; by default a line on a terminal, JSON elsewhere.
[[nodiscard]] ProgressForm progress_form(const JobArguments& arguments);

}  // namespace engram::cli
