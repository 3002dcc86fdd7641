// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/command.h"

namespace engram::cli {

void add_vault_command(CLI::App& app, ExitCode& exit_code);

}  // namespace engram::cli
