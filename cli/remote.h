// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <span>
#include <string>
#include <vector>

#include "cli/command.h"
#include "ltm/memory/query.h"
#include "ltm/memory/result.h"
#include "ltm/prediction/engine_choice.h"

namespace engram::cli {

/// A server that a command talks to.
struct RemoteArguments {
  std::string server;  ///< Endpoint; else that of the environment, else the usual one.
  std::string names;   ///< Endpoint of a name system that knows the server.
  std::string token;   ///< File.
  std::string ca;      ///< File.
  std::string timeout = "5s";
};

/// False where the program was built without servers: it has no such commands and options then.
[[nodiscard]] bool has_servers();

/// Adds --server, --names, --token, --ca and --timeout.
void add_remote_options(CLI::App& command, RemoteArguments& arguments);

/// Whether a command was told what to ask: a store or a server, not both.
/// Errors: kInvalidArgument.
[[nodiscard]] Status check_source(const std::string& store, const RemoteArguments& arguments);

/// Asks the server, or all servers that a name system knows for the memories that are asked for.
/// `engine`: of predictions; empty: the best.
Result<ltm::QueryResult> query_server(const RemoteArguments& arguments, const ltm::Query& query,
                                      const std::string& engine = {});

/// What predicts an entity at its server, measured for each horizon; the one that answers first.
Result<std::vector<std::vector<ltm::EngineRecord>>> engines_at_server(
    const RemoteArguments& arguments, const ltm::MemoryId& entity,
    std::span<const Duration> horizons);

enum class ServerFigures { kText, kJson, kMetrics };

/// Prints what a server counts, or the servers that a name system knows.
ExitCode show_server(const RemoteArguments& arguments, ServerFigures form);

}  // namespace engram::cli
