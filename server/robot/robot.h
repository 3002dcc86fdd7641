// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "server/robot/robot_config.h"

namespace engram::server {

/// Everything that one process serves: a name system, memory servers with their prior knowledge,
/// and the state of the machine.
///
/// Owns: threads of the servers, and one that watches the machine.
/// Threading: one thread.
/// Source: docs/server.md.
class Robot {
 public:
  struct Options {
    ltm::ModelLoader loader;                ///< Null: latents cannot be decoded.
    std::filesystem::path host_root = "/";  ///< See HostReader.
    /// Name of the machine; empty: the host name of the system.
    std::string host;
    Duration interval = std::chrono::seconds(1);  ///< Interval of looks at the machine.
    /// What erasing needs of the rooms that learn, see memory::MemoryService::Options.
    memory::EraseTools erasing;
  };

  /// Starts the name system first, then each server. With a name system in this process, a server
  /// is registered once it has its prior knowledge. If any server cannot start, nothing is left
  /// running.
  /// Errors: those of MemoryServer::start, NamesServer::start, commit_prior and HostWatch::create.
  static Result<std::unique_ptr<Robot>> start(const RobotConfig& config, Options options);
  static Result<std::unique_ptr<Robot>> start(const RobotConfig& config) {
    return start(config, {});
  }
  /// Calls stop() and logs failures.
  ~Robot();

  /// A running server, for people and scripts that look for it.
  struct ServerSummary {
    std::string name;
    std::vector<std::string> memories;   ///< Empty: any memory.
    std::vector<std::string> endpoints;  ///< With the ports that the system chose.
    std::filesystem::path store;         ///< Empty: no store.
  };
  [[nodiscard]] std::vector<ServerSummary> servers() const;

  /// The endpoints of the name system in this process; empty if there is none.
  [[nodiscard]] std::vector<std::string> names() const;

  /// How one server stopped.
  struct StoppedServer {
    std::string server;
    Status status;  ///< Why data could not be handed to the store and is lost.
    memory::MemoryService::Counters counters;
  };
  /// Stops accepting commits, hands everything to the stores, and seals them. The result has the
  /// order of the servers.
  std::vector<StoppedServer> stop();

 private:
  struct State;
  explicit Robot(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace engram::server
