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
  std::filesystem::path prior;  ///< Directory of prior knowledge; empty: none.
  /// What its working memory may take however tight RAM is. Unit: bytes.
  uint64_t min_bytes = uint64_t{32} << 20;
};

/// Where the Memory Name System is: in this process, or elsewhere.
struct NamesConfig {
  std::vector<Endpoint> listen;  ///< Of one in this process; empty: elsewhere.
  std::optional<Endpoint> at;    ///< Of one elsewhere.
  std::filesystem::path token;   ///< File with what servers show to it; empty: nothing.
  std::filesystem::path ca;      ///< PEM: who vouches for it.
};

/// What one process serves.
struct RobotConfig {
  std::vector<ServerConfig> servers;
  std::optional<NamesConfig> names;
  /// Of all servers, and of the name system in this process.
  ListenPolicy::Options security;
  /// Index of the server that has the memory SystemState; nothing: nobody says how the host is.
  std::optional<size_t> system_state;
};

/// One server of all memories, with a store, where programs of this user look for it.
/// Errors: those of default_endpoint.
Result<RobotConfig> robot_of_store(const std::filesystem::path& store);

/// Reads robot.yaml. `name` is what errors call it; relative paths start at `directory`.
/// Errors: kInvalidArgument naming file, line and key; those of reading a recording configuration.
/// Source: docs/server.md, section "Configuration".
Result<RobotConfig> parse_robot_config(std::string_view text, const std::string& name,
                                       const std::filesystem::path& directory);

/// Errors: kNotFound and kUnavailable too.
Result<RobotConfig> read_robot_config(const std::filesystem::path& path);

/// What robot.yaml calls the modes: "what-leaves", "everything", "latest".
[[nodiscard]] std::string_view to_string(ltm::StoreMode mode);

}  // namespace engram::server
