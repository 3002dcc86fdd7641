// SPDX-License-Identifier: Apache-2.0
#include "cli/server_commands.h"

#include <cstdio>

namespace engram::cli {

void add_server_commands(CLI::App& app, ExitCode& exit_code) {
  add_serve_command(app, exit_code);
  add_replay_command(app, exit_code);
  add_mns_command(app, exit_code);
  add_commit_command(app, exit_code);
  add_watch_command(app, exit_code);
  add_skill_command(app, exit_code);
  add_listen_command(app, exit_code);
  add_audit_command(app, exit_code);
}

void print_now(const std::string& line) {
  print(line);
  std::fflush(stdout);
}

}  // namespace engram::cli
