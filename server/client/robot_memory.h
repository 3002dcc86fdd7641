// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "server/client/memory_client.h"
#include "server/names/registration.h"

namespace engram::server {

/// What became of the part of a request that went to one server.
struct ServerOutcome {
  std::string server;  ///< Empty: no server has this.
  Status status;
};

/// What all servers that were asked know together.
struct RobotAnswer {
  ltm::QueryResult result;
  std::vector<ServerOutcome> missing;  ///< Servers that could not be reached.
};

/// A server of the robot, and what it says of itself.
struct RobotServer {
  Registration registration;
  Result<ServerInfo> info;
};

/// The memories of a robot, wherever they are: a client addresses memories, and the name system
/// knows their servers. What it said is kept, and asked for anew when a server fails; while it
/// cannot be reached, what it said last holds. A server without named memories takes all that
/// nobody else has.
///
/// Of the endpoints of a server the nearest is used: one of this host that this server answers at,
/// else the others in their order.
/// Threading: thread-safe.
/// Source: docs/server.md.
class RobotMemory {
 public:
  /// `options.timeout`: of each call, renewals and retries included. Waits for nobody.
  /// Errors: as NamesClient::connect.
  static Result<std::unique_ptr<RobotMemory>> connect(const std::string& names,
                                                      const ClientOptions& options = {});
  ~RobotMemory();

  /// Commits to each server what is of its memories, to all of them at once. Where one is gone or
  /// has moved, it is looked for until the timeout. Each part is all or nothing; `outcomes`, where
  /// given, has one for each.
  /// Errors: those of MemoryClient::commit, naming every server that failed; kNotFound where no
  /// server has a memory.
  Status commit(const ltm::Commit& commit, CommitDurability durability = CommitDurability::kDefault,
                std::vector<ServerOutcome>* outcomes = nullptr);

  /// Asks all servers that may have what is asked for at once, and unites their answers. A server
  /// that has no such entity has nothing to add; one that was there seconds ago is waited for.
  /// Errors: kNotFound where none has; kUnavailable naming the servers that could not be reached;
  /// those of MemoryClient::query.
  Result<ltm::QueryResult> query(const ltm::Query& query, const std::string& engine = {});

  /// The same, but what cannot be reached is told beside the answer, and waited for less: it is
  /// looked for once.
  /// Errors: the same, kUnavailable where no server at all could be reached.
  Result<RobotAnswer> query_reachable(const ltm::Query& query, const std::string& engine = {});

  /// See MemoryClient::declare.
  Status declare(const ltm::MemoryId& segment, const idf::Type& type);

  /// See MemoryClient::engines.
  Result<std::vector<std::vector<ltm::EngineRecord>>> engines(const ltm::MemoryId& entity,
                                                              std::span<const Duration> horizons);

  /// Subscribes to all servers that may have such entities, those that arrive or move later
  /// included; what is lost meanwhile is told by on_interrupted. Handlers are called one at a time.
  /// Returns when the servers that are there now say that they tell; one that cannot be reached
  /// yet is told by on_interrupted, and subscribed to when it can be.
  /// Errors: kInvalidArgument; what a server refuses the subscription for.
  Result<std::unique_ptr<Subscription>> subscribe(const SubscriptionOptions& options,
                                                  SubscriptionHandlers handlers);

  /// Waits until a server has this memory, and answers.
  /// Errors: kUnavailable after `timeout`.
  Status wait_for_memory(const std::string& name, Duration timeout);

  /// All servers that the name system knows, asked at once.
  /// Errors: those of NamesClient::resolve.
  Result<std::vector<RobotServer>> info();

 private:
  struct State;
  explicit RobotMemory(std::shared_ptr<State> state);
  std::shared_ptr<State> state_;
};

}  // namespace engram::server
