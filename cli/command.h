// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

#include "ltm/core/status.h"
#include "reports/plain/output.h"

namespace engram::cli {

/// What the program tells its caller. Source: docs/design.md, section 4.
enum class ExitCode : int {
  kDone = 0,
  kFailed = 1,
  kWrongUsage = 2,
  kDoneWithLoss = 3,  ///< Finished, but data was damaged or lost on the way.
};

using reports::Json;
using reports::print;
using reports::print_json;

/// Adds a command to the program; running it sets `exit_code`.
void add_import_command(CLI::App& app, ExitCode& exit_code);
void add_info_command(CLI::App& app, ExitCode& exit_code);
void add_augment_command(CLI::App& app, ExitCode& exit_code);
void add_consolidate_command(CLI::App& app, ExitCode& exit_code);
void add_query_command(CLI::App& app, ExitCode& exit_code);
void add_models_command(CLI::App& app, ExitCode& exit_code);
void add_crossval_command(CLI::App& app, ExitCode& exit_code);
void add_ls_command(CLI::App& app, ExitCode& exit_code);
void add_export_command(CLI::App& app, ExitCode& exit_code);
void add_eval_command(CLI::App& app, ExitCode& exit_code);
void add_predict_command(CLI::App& app, ExitCode& exit_code);
void add_forget_command(CLI::App& app, ExitCode& exit_code);
void add_compact_command(CLI::App& app, ExitCode& exit_code);
void add_simulate_command(CLI::App& app, ExitCode& exit_code);
void add_check_command(CLI::App& app, ExitCode& exit_code);
void add_recover_command(CLI::App& app, ExitCode& exit_code);
void add_idf_command(CLI::App& app, ExitCode& exit_code);

/// serve, mns, commit and watch; none where the program is built without servers.
void add_server_commands(CLI::App& app, ExitCode& exit_code);

/// Reads the arguments and runs the command that they name, which sets `exit_code`. Returns it, or
/// kWrongUsage after telling what is wrong with the arguments. Options' words of earlier versions
/// are taken with a warning.
ExitCode run_command(CLI::App& app, int argc, char** argv, const ExitCode& exit_code);

/// Takes a value of earlier versions for the one in its place, with a warning, until version 0.3.
/// For Option::transform.
[[nodiscard]] CLI::Validator old_value(const std::string& old, const std::string& now);

/// Runs a program: an exception that nobody caught is told on stderr.
int exit_code_of(const std::function<ExitCode()>& program);

/// What stands below `engram idf`, for a program that is nothing else.
void add_idf_commands(CLI::App& app, ExitCode& exit_code);

/// Tells an error on stderr. The exit code is kFailed.
ExitCode fail(const Status& status);

/// kDone; where it is an error, tells it as fail() does.
ExitCode done_or_failed(const Status& status);

/// Tells an error of arguments on stderr. The exit code is kWrongUsage.
ExitCode wrong_usage(const Status& status);

/// Checks for CLI11 that an argument reads as what it should be.
[[nodiscard]] CLI::Validator duration_text();
[[nodiscard]] CLI::Validator time_text();
[[nodiscard]] CLI::Validator entity_text();

}  // namespace engram::cli
