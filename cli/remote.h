// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "cli/command.h"
#include "memory/memory.h"

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

/// The memory of a command: the store that it names, opened as `options` say, else the server, or
/// all servers that the name system knows.
/// Errors: those of Memory::open and Memory::connect; kUnavailable where no server listens at the
/// socket that is meant.
Result<std::unique_ptr<Memory>> open_memory(const std::string& store, const OpenOptions& options,
                                            const RemoteArguments& arguments);

/// The same of servers alone.
Result<std::unique_ptr<Memory>> connect_memory(const RemoteArguments& arguments);

enum class ServerFigures { kText, kJson, kMetrics };

/// Prints what a server counts, or the servers that a name system knows.
ExitCode show_server(const RemoteArguments& arguments, ServerFigures form);

}  // namespace engram::cli
