// SPDX-License-Identifier: Apache-2.0
// Replaces the live kitchen in a program that is built without servers (ENGRAM_SERVER).
#include "cli/live_kitchen.h"

namespace engram::cli {

void add_live_options(CLI::App& /*kitchen*/, LiveKitchenArguments& /*arguments*/) {}

ExitCode run_live_kitchen(const datasets::KitchenOptions& /*options*/,
                          const LiveKitchenArguments& /*arguments*/,
                          const std::vector<std::string>& /*for_drivers*/) {
  return fail(failed_precondition("this program was built without servers"));
}

void add_live_kitchen_commands(CLI::App& /*simulate*/, ExitCode& /*exit_code*/) {}

}  // namespace engram::cli
