// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/command.h"

namespace engram::cli {

/// Adds `engram simulate kitchen`. In a program that is built without the kitchen, the command says
/// so.
void add_kitchen_command(CLI::App& simulate, ExitCode& exit_code);

}  // namespace engram::cli
