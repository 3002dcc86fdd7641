// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

#include "ltm/core/status.h"
#include "reports/plain/output.h"

namespace engram::cli {

/// The program's exit codes.
/// Source: docs/design.md, section 4.
enum class ExitCode : int {
  kDone = 0,
  kFailed = 1,
  kWrongUsage = 2,
  kDoneWithLoss = 3,  ///< Finished, but data was damaged or lost.
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
void add_ask_command(CLI::App& app, ExitCode& exit_code);
void add_tell_command(CLI::App& app, ExitCode& exit_code);
void add_notice_command(CLI::App& app, ExitCode& exit_code);
void add_similar_command(CLI::App& app, ExitCode& exit_code);
void add_why_salient_command(CLI::App& app, ExitCode& exit_code);
void add_models_command(CLI::App& app, ExitCode& exit_code);
void add_crossval_command(CLI::App& app, ExitCode& exit_code);
void add_ls_command(CLI::App& app, ExitCode& exit_code);
void add_export_command(CLI::App& app, ExitCode& exit_code);
void add_eval_command(CLI::App& app, ExitCode& exit_code);
void add_learn_answers_command(CLI::App& app, ExitCode& exit_code);
void add_learn_sights_command(CLI::App& app, ExitCode& exit_code);
void add_notice_sights_command(CLI::App& app, ExitCode& exit_code);
void add_predict_command(CLI::App& app, ExitCode& exit_code);
void add_forget_command(CLI::App& app, ExitCode& exit_code);
void add_redact_command(CLI::App& app, ExitCode& exit_code);
void add_compact_command(CLI::App& app, ExitCode& exit_code);
void add_simulate_command(CLI::App& app, ExitCode& exit_code);
void add_check_command(CLI::App& app, ExitCode& exit_code);
void add_recover_command(CLI::App& app, ExitCode& exit_code);
void add_reflect_command(CLI::App& app, ExitCode& exit_code);
void add_idf_command(CLI::App& app, ExitCode& exit_code);
void add_map_command(CLI::App& app, ExitCode& exit_code);
void add_view_command(CLI::App& app, ExitCode& exit_code);
void add_mcp_command(CLI::App& app, ExitCode& exit_code);

/// Adds serve, replay, mns, commit, watch, skill and audit; nothing in a program that is built
/// without servers.
void add_server_commands(CLI::App& app, ExitCode& exit_code);

/// Parses the arguments and runs the command that they name, which sets `exit_code`. Returns that,
/// or kWrongUsage after reporting what is wrong with the arguments. Options' words of earlier
/// versions are accepted with a warning.
ExitCode run_command(CLI::App& app, int argc, char** argv, const ExitCode& exit_code);

/// Returns the options that a command was given, except those in `but`, as arguments for a child.
[[nodiscard]] std::vector<std::string> arguments_of(const CLI::App& command,
                                                    const std::vector<std::string>& but);

/// Replaces an option's value of earlier versions by the current one, with a warning, until version
/// 0.3. For Option::transform.
[[nodiscard]] CLI::Validator old_value(const std::string& old, const std::string& now);

/// Runs a program and reports an uncaught exception on stderr.
int exit_code_of(const std::function<ExitCode()>& program);

/// Adds the commands of `engram idf` to a program that has no others.
void add_idf_commands(CLI::App& app, ExitCode& exit_code);

/// Prints an error on stderr. Returns kFailed.
ExitCode fail(const Status& status);

/// Returns kDone, or the result of fail() for an error.
ExitCode done_or_failed(const Status& status);

/// Prints an error of the arguments on stderr. Returns kWrongUsage.
ExitCode wrong_usage(const Status& status);

/// CLI11 validators: an argument must parse as a duration, a time or an entity.
[[nodiscard]] CLI::Validator duration_text();
[[nodiscard]] CLI::Validator time_text();
[[nodiscard]] CLI::Validator entity_text();

}  // namespace engram::cli
