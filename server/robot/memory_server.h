// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "memory/live/memory_service.h"
#include "server/names/registration.h"
#include "server/rpc/rpc_context.h"
#include "server/rpc/rpc_server.h"

namespace engram::server {

class NamesClient;

/// One memory server: its memories, and what answers about them over gRPC.
///
/// Owns: threads.
/// Threading: one thread.
class MemoryServer {
 public:
  struct Options {
    memory::MemoryService::Options service;
    RpcServer::Options rpc;
    memory::MemoryService::Durability durability = memory::MemoryService::Durability::kMemory;
    std::filesystem::path tokens;  ///< Empty: whoever can connect may do everything.
    /// What the name system tells others; empty: where it listens.
    std::vector<Endpoint> reached_at;
    int threads = 2;  ///< That decode and predict.
    /// What is shared with clients of this host, beside the first Unix socket; nothing: no memory
    /// is.
    std::optional<SharedPool::Options> sharing = SharedPool::Options{};
  };

  /// `names`: where it registers; may be null, else outlives it.
  /// Errors: those of memory::MemoryService::open, AccessPolicy::read_file and RpcServer::start.
  static Result<std::unique_ptr<MemoryServer>> start(const Options& options,
                                                     ltm::ModelLoader loader,
                                                     NamesClient* names = nullptr);
  /// As stop(); what fails is logged.
  ~MemoryServer();

  [[nodiscard]] std::vector<std::string> endpoints() const;
  [[nodiscard]] memory::MemoryService& service();

  /// What a name system is told of it.
  [[nodiscard]] Registration registration() const;

  /// Commits what this process itself knows, and tells subscribers.
  Status commit(ltm::Commit commit);

  /// Takes no more, hands everything to the store, and seals it.
  /// Errors: those of memory::MemoryService::close.
  Status stop();

 private:
  struct State;
  explicit MemoryServer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace engram::server
