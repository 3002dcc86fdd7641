// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "cli/command.h"
#include "memory/memory.h"

namespace engram::cli {

/// The server that a command uses.
struct RemoteArguments {
  std::string server;  ///< Endpoint; empty: that of the environment, else the default one.
  std::string names;   ///< Endpoint of a name system that knows the server.
  std::string token;   ///< File with the token.
  std::string ca;      ///< PEM file of the certificate authority.
  std::string timeout = "5s";
};

/// False if the program is built without servers; it then lacks these commands and options.
[[nodiscard]] bool has_servers();

/// Adds --server, --names, --token, --ca and --timeout.
void add_remote_options(CLI::App& command, RemoteArguments& arguments);

/// Checks that a command was given a store or a server, not both.
/// Errors: kInvalidArgument.
[[nodiscard]] Status check_source(const std::string& store, const RemoteArguments& arguments);

/// Opens the memory of a command: the named store, opened with `options`, else the server, or all
/// servers of the name system.
/// Errors: those of Memory::open and Memory::connect; kUnavailable if no server listens at the
/// socket.
Result<std::unique_ptr<Memory>> open_memory(const std::string& store, const OpenOptions& options,
                                            const RemoteArguments& arguments);

/// Like open_memory(), for servers only.
Result<std::unique_ptr<Memory>> connect_memory(const RemoteArguments& arguments);

/// Returns the names of the memories that a server holds, or that it holds all.
[[nodiscard]] std::string memories_text(const std::vector<std::string>& memories);

enum class ServerFigures { kText, kJson, kMetrics };

/// Prints the figures of a server, or the servers that a name system knows.
ExitCode show_server(const RemoteArguments& arguments, ServerFigures form);

}  // namespace engram::cli
