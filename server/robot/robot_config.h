// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/client/memory_client.h"
#include "server/robot/memory_server.h"

namespace engram::server {

/// One server of a robot.
struct ServerConfig {
  MemoryServer::Options options;
  std::filesystem::path prior;  ///< Folder of prior knowledge; empty: none.
  /// What working memory may take even if the machine's RAM is tight. Unit: bytes.
  uint64_t min_bytes = uint64_t{32} << 20;
};

/// The Memory Name System that a process uses: its own, or one elsewhere.
struct NamesConfig {
  /// Endpoints of a name system in this process; empty: it is elsewhere.
  std::vector<Endpoint> listen;
  std::optional<Endpoint> at;   ///< Endpoint of a name system elsewhere.
  std::filesystem::path token;  ///< File with the token that servers send to it; empty: none.
  /// PEM file of the certificate authority that signed its certificate.
  std::filesystem::path ca;
};

/// What one process serves.
struct RobotConfig {
  std::vector<ServerConfig> servers;
  std::optional<NamesConfig> names;
  /// Applies to all servers, and to the name system in this process.
  ListenPolicy::Options security;
  /// The log of who asked what of the servers; empty: there is none. See AuditLog.
  std::filesystem::path audit;
  /// Index of the server that has the memory SystemState; empty: no server stores the state of the
  /// host.
  std::optional<size_t> system_state;
};

/// Returns the configuration of one server for all memories, with a store, at the user's default
/// endpoint.
/// Errors: those of default_endpoint.
Result<RobotConfig> robot_of_store(const std::filesystem::path& store);

/// Parses the text of a robot.yaml. Errors call the file `name`; relative paths start at
/// `directory`.
/// Errors: kInvalidArgument naming file, line and key; those of reading a recording configuration.
/// Source: docs/server.md, section "Configuration".
Result<RobotConfig> parse_robot_config(std::string_view text, const std::string& name,
                                       const std::filesystem::path& directory);

/// Reads and parses a file.
/// Errors: those of parse_robot_config; kNotFound; kUnavailable.
Result<RobotConfig> read_robot_config(const std::filesystem::path& path);

/// The name of a mode in robot.yaml: "what-leaves", "everything" or "latest".
[[nodiscard]] std::string_view to_string(ltm::StoreMode mode);

}  // namespace engram::server
