// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/command.h"

namespace engram::cli {

void add_serve_command(CLI::App& app, ExitCode& exit_code);
void add_replay_command(CLI::App& app, ExitCode& exit_code);
void add_mns_command(CLI::App& app, ExitCode& exit_code);
void add_commit_command(CLI::App& app, ExitCode& exit_code);
void add_watch_command(CLI::App& app, ExitCode& exit_code);
void add_skill_command(CLI::App& app, ExitCode& exit_code);
void add_listen_command(CLI::App& app, ExitCode& exit_code);
void add_audit_command(CLI::App& app, ExitCode& exit_code);

/// Writes a line to stdout and flushes it, for programs that wait for the line.
void print_now(const std::string& line);

}  // namespace engram::cli
