// SPDX-License-Identifier: Apache-2.0
// Replaces the commands that use networks in a program that is built without servers
// (ENGRAM_SERVER).
#include "cli/remote_forget.h"

namespace engram::cli {

bool has_servers() {
  return false;
}

void add_remote_options(CLI::App& /*command*/, RemoteArguments& /*arguments*/) {}

Status check_source(const std::string& store, const RemoteArguments& /*arguments*/) {
  return store.empty() ? invalid_argument("store is required") : Status();
}

Result<std::unique_ptr<Memory>> connect_memory(const RemoteArguments& /*arguments*/) {
  return failed_precondition("this program was built without servers");
}

ExitCode show_server(const RemoteArguments& /*arguments*/, ServerFigures /*form*/) {
  return fail(failed_precondition("this program was built without servers"));
}

ExitCode forget_on_server(const RemoteForget& /*what*/, const Agreed& /*is_agreed*/) {
  return fail(failed_precondition("this program was built without servers"));
}

void add_server_commands(CLI::App& /*app*/, ExitCode& /*exit_code*/) {}

}  // namespace engram::cli
