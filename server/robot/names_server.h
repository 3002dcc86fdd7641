// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "server/names/name_registry.h"
#include "server/rpc/rpc_server.h"

namespace engram::server {

/// The Memory Name System of a robot: tells over gRPC which server has which memory.
///
/// Owns: the threads of gRPC.
/// Threading: one thread.
class NamesServer {
 public:
  struct Options {
    RpcServer::Options rpc;
    NameRegistry::Options registry;
    std::filesystem::path tokens;  ///< Empty: every client that can connect may do everything.
  };

  /// Errors: those of NameRegistry::create, AccessPolicy::read_file and RpcServer::start.
  static Result<std::unique_ptr<NamesServer>> start(const Options& options);
  ~NamesServer();

  [[nodiscard]] std::vector<std::string> endpoints() const;
  [[nodiscard]] NameRegistry& registry();

 private:
  struct State;
  explicit NamesServer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace engram::server
