// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/remote.h"
#include "datasets/kitchen/kitchen.h"

namespace engram::cli {

/// What `engram simulate kitchen --live` is told beside the options of a recording.
struct LiveKitchenArguments {
  bool is_live = false;
  bool is_stepped = false;
  bool is_held = false;
  bool is_json = false;
  double speed = 1;
  double seconds = 0;  ///< 0: until Ctrl-C.
  std::string chair;   ///< Where it stands at the beginning, as X,Y; empty: it is away.
  std::string person;
  std::string bus;  ///< The endpoint of the body; empty: the usual one.
  RemoteArguments remote;
};

/// Adds the options of a live kitchen to the command that records one.
void add_live_options(CLI::App& kitchen, LiveKitchenArguments& arguments);

/// Checks that no option of a live kitchen was given to one that records.
/// Errors: kInvalidArgument naming it.
[[nodiscard]] Status check_recorded(const CLI::App& given);

/// Runs the body of the robot, and its drivers as programs of their own, until Ctrl-C.
/// `given`: the command, whose options of recordings must not be given.
ExitCode run_live_kitchen(datasets::KitchenOptions options, LiveKitchenArguments arguments,
                          const std::vector<uint64_t>& seeds, const CLI::App& given);

/// Adds `engram simulate poke`, and the hidden command that runs a driver.
void add_live_kitchen_commands(CLI::App& simulate, ExitCode& exit_code);

}  // namespace engram::cli
