// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "cli/command.h"
#include "cli/remote.h"
#include "ltm/core/time.h"
#include "ltm/memory/memory_id.h"

namespace engram::cli {

/// The options of `engram predict`, unparsed.
struct PredictArguments {
  std::string store;
  std::string entity;
  RemoteArguments remote;
  std::string at;
  std::string horizons;  ///< Empty: the default.
  std::string engine;
  std::string plan;
  std::string picture;
  std::string save;
  std::string from, to;
  size_t every = 0;
  bool is_compared = false;
  bool is_list = false;
  bool is_json = false;
};

/// Adds all of them. `arguments` must outlive the command.
void add_predict_options(CLI::App& command, PredictArguments& arguments);

/// Returns the requested horizons, or the default ones: for --list they depend on the step of the
/// entity.
[[nodiscard]] std::string horizons_text(const PredictArguments& arguments, Duration step);

/// Prints text or JSON, as requested.
void show(const PredictArguments& arguments, const std::string& text, const Json& json);

/// Returns the time of an argument that was validated; nothing if it was not given.
[[nodiscard]] std::optional<Time> time_of(const std::string& text);

/// Predicts from one moment, or lists the engines, at a server; predicts from one moment of a
/// store.
ExitCode predict_moment(const PredictArguments& arguments, const ltm::MemoryId& entity);

}  // namespace engram::cli
