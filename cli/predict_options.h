// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli/command.h"
#include "cli/remote.h"
#include "ltm/core/time.h"
#include "ltm/memory/memory_id.h"

namespace engram::cli {

/// The options of `engram predict`, as they are written.
struct PredictArguments {
  std::string store;
  std::string entity;
  RemoteArguments remote;
  std::string at;
  std::string horizons = "1..3";
  std::string engine;
  std::string plan;
  std::string ahead;
  std::string picture;
  std::string save;
  std::string from, to;
  size_t every = 0;
  bool is_compared = false;
  bool is_list = false;
  bool is_json = false;
};

/// Adds all of them. `arguments` outlives the command.
void add_predict_options(CLI::App& command, PredictArguments& arguments);

/// The horizons that were asked for, or those that --list measures of an entity of that step.
[[nodiscard]] std::string horizons_text(const PredictArguments& arguments, Duration step);

/// Text or JSON, as was asked for.
void show(const PredictArguments& arguments, const std::string& text, const Json& json);

/// Predicts, or lists what can, at a server.
ExitCode predict_at_server(const PredictArguments& arguments, const ltm::MemoryId& entity);

}  // namespace engram::cli
