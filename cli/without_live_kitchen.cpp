// SPDX-License-Identifier: Apache-2.0
// Replaces the live kitchen in a program that is built without servers (ENGRAM_SERVER).
#include "cli/live_kitchen.h"

namespace engram::cli {

void add_live_options(CLI::App& /*kitchen*/, LiveKitchenArguments& /*arguments*/) {}

Status check_recorded(const CLI::App& /*given*/) {
  return {};
}

ExitCode run_live_kitchen(datasets::KitchenOptions /*options*/, LiveKitchenArguments /*arguments*/,
                          const std::vector<uint64_t>& /*seeds*/, const CLI::App& /*given*/) {
  return fail(failed_precondition("this program was built without servers"));
}

void add_live_kitchen_commands(CLI::App& /*simulate*/, ExitCode& /*exit_code*/) {}

}  // namespace engram::cli
