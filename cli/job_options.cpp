// SPDX-License-Identifier: Apache-2.0
#include "cli/job_options.h"

#include <unistd.h>

#include "ltm/core/local_time.h"

namespace engram::cli {

void add_job_options(CLI::App& command, JobArguments& arguments, training::JobControl& job) {
  command
      .add_option(
          "--budget", arguments.budget,
          "Time for everything, measuring and encoding included: what is not done then waits "
          "for the next job")
      ->check(duration_text())
      ->excludes("--training")
      ->excludes("--steps");
  command
      .add_option("--until", arguments.until,
                  "Be done at 06:00 or '2026-03-01 06:00', local time, as with --budget")
      ->type_name("TIME")
      ->excludes("--training")
      ->excludes("--budget")
      ->excludes("--steps");
  command.add_flag("--fresh", job.is_fresh, "Do not go on from where a killed job was");
  command
      .add_option("--checkpoint-every", arguments.checkpoint_interval,
                  "How often training is kept, to go on from; 0s: never")
      ->check(duration_text())
      ->capture_default_str();
  command.add_option("--yield-file", arguments.yield_file, "Wait while this file exists");
  command.add_option("--yield-command", job.yield.command,
                     "Wait while this program ends with 0; asked every 10 s, without a shell");
  command
      .add_option("--progress", arguments.progress,
                  "On stderr: auto (line on a terminal, else json), line, json or none")
      ->check(CLI::IsMember({"auto", "line", "json", "none"}))
      ->capture_default_str();
}

Status finish_job_options(const JobArguments& arguments, training::JobControl& job) {
  if (!arguments.budget.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(const Duration budget, parse_duration(arguments.budget));
    if (budget <= Duration::zero())
      return invalid_argument("--budget: found {}, needs more than 0", arguments.budget);
    job.until = system_now() + budget;
  }
  if (!arguments.until.empty()) {
    auto until = next_local_time(arguments.until, system_now());
    if (!until.ok()) return until.status().with_context("--until");
    job.until = *until;
  }
  ENGRAM_ASSIGN_OR_RETURN(job.checkpoint_interval, parse_duration(arguments.checkpoint_interval));
  job.yield.file = arguments.yield_file;
  return {};
}

ProgressForm progress_form(const JobArguments& arguments) {
  if (arguments.progress == "none") return ProgressForm::kNone;
  if (arguments.progress == "line") return ProgressForm::kText;
  if (arguments.progress == "json") return ProgressForm::kJson;
  return ::isatty(STDERR_FILENO) != 0 ? ProgressForm::kText : ProgressForm::kJson;
}

}  // namespace engram::cli
