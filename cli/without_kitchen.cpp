// SPDX-License-Identifier: Apache-2.0
// Replaces the simulated kitchen in a program that is built without it (ENGRAM_KITCHEN).
#include "cli/scene_sources.h"
#include "cli/simulate_kitchen.h"

namespace engram::cli {

namespace {

Status without_kitchen() {
  return failed_precondition(
      "this program was built without the kitchen: needs libmujoco-dev and libegl-dev");
}

}  // namespace

void add_kitchen_command(CLI::App& simulate, ExitCode& exit_code) {
  CLI::App* kitchen = simulate.add_subcommand("kitchen", "(this program was built without it)");
  kitchen->allow_extras();
  kitchen->callback([&exit_code] { exit_code = fail(without_kitchen()); });
}

Result<std::unique_ptr<datasets::SceneSource>> make_scene_source() {
  return without_kitchen();
}

}  // namespace engram::cli
