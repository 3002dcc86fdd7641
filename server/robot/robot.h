// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "server/robot/robot_config.h"

namespace engram::server {

/// All that one process serves: a name system, memory servers with what they know from the start,
/// and how the machine is.
///
/// Owns: threads.
/// Threading: one thread.
/// Source: docs/server.md.
class Robot {
 public:
  struct Options {
    ltm::ModelLoader loader;                ///< Null: latents cannot be decoded.
    std::filesystem::path host_root = "/";  ///< See HostReader.
    std::string host;                       ///< Name of the machine; empty: as the system says.
    Duration interval = std::chrono::seconds(1);  ///< Between looks at the machine.
  };

  /// The name system first, then each server, which is registered when it knows its prior
  /// knowledge. Nothing is left running where one cannot start.
  /// Errors: those of MemoryServer::start, NamesServer::start, commit_prior and HostWatch::create.
  static Result<std::unique_ptr<Robot>> start(const RobotConfig& config, Options options);
  static Result<std::unique_ptr<Robot>> start(const RobotConfig& config) {
    return start(config, {});
  }
  /// As stop(); what fails is logged.
  ~Robot();

  /// What runs, for people and scripts to find it.
  struct ServerSummary {
    std::string name;
    std::vector<std::string> memories;   ///< Empty: any.
    std::vector<std::string> endpoints;  ///< With the ports that the system chose.
    std::filesystem::path store;         ///< Empty: none.
  };
  [[nodiscard]] std::vector<ServerSummary> servers() const;

  /// Where the name system of this process listens; empty: there is none.
  [[nodiscard]] std::vector<std::string> names() const;

  /// What became of one server's memories.
  struct StoppedServer {
    std::string server;
    Status status;  ///< Why something could not be handed to the store: that is lost.
    memory::MemoryService::Counters counters;
  };
  /// Takes no more, hands everything to the stores and seals them. In the order of the servers.
  std::vector<StoppedServer> stop();

 private:
  struct State;
  explicit Robot(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace engram::server
