// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "ltm/core/progress.h"
#include "ltm/core/time.h"
#include "ltm/idf/type.h"
#include "ltm/memory/commit.h"
#include "ltm/memory/query.h"
#include "ltm/memory/result.h"
#include "ltm/prediction/engine_choice.h"
#include "memory/memory.h"
#include "server/client/client_options.h"
#include "server/client/loan.h"
#include "server/client/sent_context.h"

namespace engram::server {

/// What a server reports about itself.
struct ServerInfo {
  std::string server;
  std::string version;
  std::vector<std::string> memories;  ///< Empty: the server takes any memory.
  std::string figures_json;
};

/// What a server is to forget; see memory::ForgetRequest.
struct ForgetCall {
  std::vector<std::string> targets;  ///< IDs of any level, or queries with a selector.
  bool erases = false;
  bool is_dry_run = false;
  ProgressSink progress{};
  std::stop_token stop{};
};

/// What a server forgot, or would; see memory::ForgetOutcome.
struct Forgotten {
  struct OfEntity {
    std::string entity;
    uint64_t snapshots = 0;
    Time first{}, last{};
  };
  std::vector<OfEntity> entities;
  uint64_t snapshots = 0;
  uint64_t from_memory = 0;
  uint64_t never_stored = 0;
  uint64_t from_store = 0;
  std::vector<std::string> notes;
  std::string erased_json;  ///< Empty: nothing was to be erased.
};

/// The client of one memory server. Its streams are opened when they are first needed, and reopened
/// after they broke.
///
/// Threading: thread-safe.
/// Source: docs/server.md.
class MemoryClient {
 public:
  /// Creates a client of the server at `endpoint` (see Endpoint) without waiting for the server.
  /// Errors: kInvalidArgument for a bad endpoint; the errors of reading the CA file.
  static Result<std::unique_ptr<MemoryClient>> connect(const std::string& endpoint,
                                                       const ClientOptions& options = {});
  ~MemoryClient();

  /// Sends a commit and waits until it is acknowledged. While the server cannot be reached, the
  /// commit is retried until the timeout; a commit that arrives twice counts once, because the
  /// server identifies it by entity and time.
  /// Errors: those of memory::MemoryService::commit; kUnavailable if there was no answer, in which
  /// case the commit may or may not have arrived.
  Status commit(const ltm::Commit& commit,
                CommitDurability durability = CommitDurability::kDefault);

  /// The same without waiting or trying again; `done` is called by a thread of the client.
  void commit(const ltm::Commit& commit, CommitDurability durability,
              std::function<void(const Status&)> done);

  /// Lends memory for the arrays of one commit. Where their segment is sensory and the server on
  /// this host, it lies where the commit puts it, and nothing is copied then; elsewhere it is
  /// memory of this process. Up to half of a ring is lent at a time.
  /// Errors: kInvalidArgument for a shape that no array can have.
  Result<Loan> lend(std::span<const ArrayToLend> arrays);

  /// Answers a query. `engine` names the engine of predictions; empty chooses the best one.
  /// `contexts` are those of entities of other servers that conditions name.
  Result<ltm::QueryResult> query(const ltm::Query& query, const std::string& engine = {},
                                 std::span<const SentContext> contexts = {});

  /// The same in parts, see Memory::query_parts. `options.timeout` is for each part.
  Status query_parts(const ltm::Query& query, const Memory::PartVisit& visit,
                     const std::string& engine = {}, std::span<const SentContext> contexts = {});

  /// The context of an entity for a query to another server; nothing if this one has no such
  /// entity. Errors: kFailedPrecondition if the server is of a version that does not know places;
  /// kResourceExhausted if it is too large to be sent.
  Result<std::optional<SentContext>> context(const ltm::MemoryId& entity);

  /// The same without waiting or trying again; `done` is called by a thread of the client.
  void query(const ltm::Query& query, const std::string& engine,
             std::function<void(Result<ltm::QueryResult>)> done);

  /// Predicts from a moment or with a plan; see Memory::predict.
  /// Errors: kFailedPrecondition if the server is of a version that predicts from now alone.
  Result<std::vector<ltm::SnapshotResult>> predict(const ltm::MemoryId& entity,
                                                   std::span<const Duration> horizons,
                                                   const PredictOptions& options);

  /// Declares the type of a segment; see Memory::declare.
  Status declare(const ltm::MemoryId& segment, const idf::Type& type);
  /// Returns one list per horizon: the engines that can predict the entity, each with its error at
  /// that horizon on the entity's own past. The first engine of each list is the one that answers.
  /// With `at` all is as of that moment.
  /// Errors: kFailedPrecondition if `at` is set and the server is of a version that does not know
  /// it.
  Result<std::vector<std::vector<ltm::EngineRecord>>> engines(const ltm::MemoryId& entity,
                                                              std::span<const Duration> horizons,
                                                              std::optional<Time> at = {});
  /// Finds moments like another one; see Memory::similar.
  /// Errors: kFailedPrecondition if the server is of a version that does not compare moments.
  Result<ltm::SimilarAnswer> similar(const ltm::SimilarRequest& request);
  /// Lets the server forget, however long that takes. It is not tried again: what a broken
  /// connection stopped is carried on by the same call.
  /// Errors: those of memory::MemoryService::forget; kFailedPrecondition if the token may not
  /// erase, or if the server is of a version that cannot forget; kCancelled.
  Result<Forgotten> forget(const ForgetCall& call);

  /// Asks the server what it is and what it has.
  Result<ServerInfo> info();
  /// Returns the server's metrics as text for Prometheus.
  Result<std::string> metrics();

  /// Subscribes to new snapshots. Returns once the server has confirmed that it sends all snapshots
  /// from then on.
  Result<std::unique_ptr<Subscription>> subscribe(const SubscriptionOptions& options,
                                                  SubscriptionHandlers handlers);

 private:
  struct State;
  explicit MemoryClient(std::shared_ptr<State> state);
  std::shared_ptr<State> state_;
};

}  // namespace engram::server
