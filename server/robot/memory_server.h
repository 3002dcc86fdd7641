// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "memory/live/memory_service.h"
#include "server/names/registration.h"
#include "server/robot/skill_host.h"
#include "server/rpc/rpc_context.h"
#include "server/rpc/rpc_server.h"

namespace engram::server {

class NamesClient;

/// One memory server: its memories, and the gRPC services that answer for them.
///
/// Owns: threads of gRPC and those that decode and predict.
/// Threading: one thread.
class MemoryServer {
 public:
  struct Options {
    memory::MemoryService::Options service;
    RpcServer::Options rpc;
    memory::MemoryService::Durability durability = memory::MemoryService::Durability::kMemory;
    std::filesystem::path tokens;     ///< Empty: every client that can connect may do everything.
    std::shared_ptr<AuditLog> audit;  ///< Where it is noted who asked what; null: nowhere.
    /// The endpoints that the name system gives to clients; empty: the endpoints it listens on.
    std::vector<Endpoint> reached_at;
    int threads = 2;  ///< Number of threads that decode and predict.
    /// Shared memory for clients on this host; its socket is beside the first Unix socket. Empty:
    /// no memory is shared.
    std::optional<SharedPool::Options> sharing = SharedPool::Options{};
    /// The skill memory (docs/skills.md); empty: the server has none.
    struct Skills {
      /// The entity whose snapshots tell the time; empty: the clock of the operating system.
      std::optional<ltm::MemoryId> clock{};
      std::filesystem::path token{};  ///< What it shows other servers of the robot; empty: nothing.
      /// Gives the memory in which it looks up conditions and to which it commits; null: that of
      /// this server.
      SkillHost::OpenMemory open{};
    };
    std::optional<Skills> skills = Skills{};
  };

  /// Starts a server. It registers at `names`, which may be null and otherwise must outlive the
  /// server.
  /// Errors: those of memory::MemoryService::open, AccessPolicy::read_file and RpcServer::start.
  static Result<std::unique_ptr<MemoryServer>> start(const Options& options,
                                                     ltm::ModelLoader loader,
                                                     NamesClient* names = nullptr);
  /// Calls stop() and logs a failure.
  ~MemoryServer();

  [[nodiscard]] std::vector<std::string> endpoints() const;
  [[nodiscard]] memory::MemoryService& service();

  /// What the server reports to a name system.
  [[nodiscard]] Registration registration() const;

  /// Starts the skill memory, if this is the server of the memory `Skill` or has something of it.
  /// Otherwise it starts when it is first needed.
  /// Errors: those of SkillHost::get.
  Status begin_skills();

  /// Commits data of this process itself and notifies subscribers.
  Status commit(ltm::Commit commit);

  /// Stops accepting commits, hands everything to the store, and seals the store.
  /// Errors: those of memory::MemoryService::close.
  Status stop();

 private:
  struct State;
  explicit MemoryServer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace engram::server
