// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/command.h"

namespace engram::cli {

/// The hidden subcommand of `engram simulate` that runs one driver of a live kitchen.
inline constexpr const char* kDriverCommand = "kitchen-driver";

/// Adds it. It writes to stdout a line of JSON for each thing that it has to say: {"says": words}
/// or {"figures": {name: number}}.
void add_kitchen_driver_command(CLI::App& simulate, ExitCode& exit_code);

}  // namespace engram::cli
