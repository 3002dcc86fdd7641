// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/command.h"

namespace engram::cli {

/// Adds `engram simulate kitchen`; says why it cannot where the program is built without.
void add_kitchen_command(CLI::App& simulate, ExitCode& exit_code);

}  // namespace engram::cli
