// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "ltm/core/time.h"
#include "ltm/idf/type.h"
#include "ltm/memory/commit.h"
#include "ltm/memory/query.h"
#include "ltm/memory/result.h"
#include "ltm/prediction/engine_choice.h"
#include "memory/memory.h"

namespace engram::server {

/// How to reach servers.
struct ClientOptions {
  std::string token;                            ///< Empty: none.
  std::filesystem::path ca;                     ///< PEM: who vouches for servers on other machines.
  Duration timeout = std::chrono::seconds(10);  ///< Of each call, retries included.
  bool tries_again = true;  ///< Where a server cannot be reached; else the call fails at once.
  int max_message_bytes = 256 << 20;
  /// Large payloads go through shared memory where the server is reached by a Unix socket. What a
  /// subscriber keeps of them, it keeps from the server.
  bool shares_memory = true;
};

/// What a server says of itself.
struct ServerInfo {
  std::string server;
  std::string version;
  std::vector<std::string> memories;  ///< Empty: any.
  std::string figures_json;
};

/// A memory server, as programs use it. Streams are opened when they are needed, and again when
/// they broke.
///
/// Threading: thread-safe.
/// Source: docs/server.md.
class MemoryClient {
 public:
  /// `endpoint`: see Endpoint. Does not wait for the server.
  /// Errors: kInvalidArgument; those of reading the CA file.
  static Result<std::unique_ptr<MemoryClient>> connect(const std::string& endpoint,
                                                       const ClientOptions& options = {});
  ~MemoryClient();

  /// Waits until it is acknowledged. Where the server cannot be reached it is tried again until the
  /// timeout: of the same entity and time, a commit that came twice counts once.
  /// Errors: those of memory::MemoryService::commit; kUnavailable: it may have arrived or not.
  Status commit(const ltm::Commit& commit,
                CommitDurability durability = CommitDurability::kDefault);

  /// The same without waiting or trying again; `done` is called by a thread of the client.
  void commit(const ltm::Commit& commit, CommitDurability durability,
              std::function<void(const Status&)> done);

  /// `engine`: of predictions; empty: the best.
  Result<ltm::QueryResult> query(const ltm::Query& query, const std::string& engine = {});

  /// The same without waiting or trying again; `done` is called by a thread of the client.
  void query(const ltm::Query& query, const std::string& engine,
             std::function<void(Result<ltm::QueryResult>)> done);

  Status declare(const ltm::MemoryId& segment, const idf::Type& type);
  /// What predicts an entity, measured for each horizon; the one that answers first.
  Result<std::vector<std::vector<ltm::EngineRecord>>> engines(const ltm::MemoryId& entity,
                                                              std::span<const Duration> horizons);
  Result<ServerInfo> info();
  Result<std::string> metrics();

  /// Returns when the server says that all from now on is told.
  Result<std::unique_ptr<Subscription>> subscribe(const SubscriptionOptions& options,
                                                  SubscriptionHandlers handlers);

 private:
  struct State;
  explicit MemoryClient(std::shared_ptr<State> state);
  std::shared_ptr<State> state_;
};

}  // namespace engram::server
