// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/client/memory_client.h"
#include "server/names/registration.h"

namespace engram::server {

/// The outcome of the part of a request that went to one server.
struct ServerOutcome {
  std::string server;  ///< Empty: no server has this memory.
  Status status;
};

/// The united answer of all servers that were asked.
struct RobotAnswer {
  ltm::QueryResult result;
  std::vector<ServerOutcome> missing;  ///< Servers that could not be reached.
};

/// A server of the robot, with what it reports about itself.
struct RobotServer {
  Registration registration;
  Result<ServerInfo> info;
};

/// All memories of a robot, across its servers. A client addresses memories; the name system knows
/// which server has which memory. The client keeps the name system's last answer, asks again when a
/// server fails, and continues with the last answer while the name system cannot be reached. A
/// server without named memories takes every memory that no other server has.
///
/// The client uses the nearest endpoint of a server: an endpoint of this host at which this very
/// server answers, otherwise the other endpoints in their order.
/// Threading: thread-safe.
/// Source: docs/server.md.
class RobotMemory {
 public:
  /// Creates a client without waiting for anything. `options.timeout` bounds each call, including
  /// renewals of the list of servers and retries.
  /// Errors: those of NamesClient::connect.
  static Result<std::unique_ptr<RobotMemory>> connect(const std::string& names,
                                                      const ClientOptions& options = {});
  ~RobotMemory();

  /// Sends to each server the updates of its memories, to all servers at once. If a server is gone
  /// or a memory has moved, the client looks for it until the timeout. Each server's part is all or
  /// nothing; `outcomes`, if given, receives one outcome per part.
  /// Errors: those of MemoryClient::commit, naming every server that failed; kNotFound if no server
  /// has a memory.
  Status commit(const ltm::Commit& commit, CommitDurability durability = CommitDurability::kDefault,
                std::vector<ServerOutcome>* outcomes = nullptr);

  /// Asks all servers that may have matching entities at once and unites their answers. A server
  /// without such an entity adds nothing; a server that disappeared within the last seconds is
  /// waited for.
  /// Errors: kNotFound if no server has the entity; kUnavailable naming the servers that could not
  /// be reached; those of MemoryClient::query.
  Result<ltm::QueryResult> query(const ltm::Query& query, const std::string& engine = {});

  /// The same in parts, see Memory::query_parts: server by server, in the order of their names. A
  /// server is waited for until its first part was visited; after that an error ends the answer.
  Status query_parts(const ltm::Query& query, const Memory::PartVisit& visit,
                     const std::string& engine = {});

  /// Like query(), but servers that cannot be reached are listed beside the answer, and the client
  /// looks for them only once more instead of until the timeout.
  /// Errors: those of query(), but kUnavailable only if no server at all could be reached.
  Result<RobotAnswer> query_reachable(const ltm::Query& query, const std::string& engine = {});

  /// Predicts from a moment or with a plan at the server that has the entity, which needs to have
  /// the plan too.
  /// Errors: those of MemoryClient::predict.
  Result<std::vector<ltm::SnapshotResult>> predict(const ltm::MemoryId& entity,
                                                   std::span<const Duration> horizons,
                                                   const PredictOptions& options);

  /// See MemoryClient::declare.
  Status declare(const ltm::MemoryId& segment, const idf::Type& type);

  /// See MemoryClient::engines.
  Result<std::vector<std::vector<ltm::EngineRecord>>> engines(const ltm::MemoryId& entity,
                                                              std::span<const Duration> horizons,
                                                              std::optional<Time> at = {});

  /// Finds moments like another one at the server that has the entity, which needs to have the
  /// other entities too; see Memory::similar.
  Result<ltm::SimilarAnswer> similar(const ltm::SimilarRequest& request);

  /// Subscribes to all servers that may have matching entities, including servers that arrive or
  /// move later. `on_interrupted` reports snapshots lost meanwhile. Handlers are called one at a
  /// time. Returns once all servers that are reachable now have confirmed the subscription;
  /// `on_interrupted` reports a server that cannot be reached yet, and the client subscribes to it
  /// when it can.
  /// Errors: kInvalidArgument; any error with which a server refuses the subscription.
  Result<std::unique_ptr<Subscription>> subscribe(const SubscriptionOptions& options,
                                                  SubscriptionHandlers handlers);

  /// Waits until a server has this memory and answers.
  /// Errors: kUnavailable after `timeout`.
  Status wait_for_memory(const std::string& name, Duration timeout);

  /// Returns all servers that the name system knows, and asks them all at once.
  /// Errors: those of NamesClient::resolve.
  Result<std::vector<RobotServer>> info();

 private:
  struct State;
  explicit RobotMemory(std::shared_ptr<State> state);
  std::shared_ptr<State> state_;
};

}  // namespace engram::server
