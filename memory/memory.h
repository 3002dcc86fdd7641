// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/core/time.h"
#include "ltm/idf/type.h"
#include "ltm/memory/commit.h"
#include "ltm/memory/query.h"
#include "ltm/memory/result.h"
#include "ltm/prediction/engine_choice.h"
#include "memory/live/subscription.h"

namespace engram {

/// When a commit counts as done.
enum class CommitDurability : uint8_t {
  kDefault,  ///< A memory that this program opened: kJournal. A server: what it is configured for.
  kMemory,   ///< When others can read it.
  kJournal,  ///< When it survives a killed process, as far as the filters keep it.
};

/// How a program opens a memory of its own.
struct OpenOptions {
  /// Only asks. Any number of programs may, beside the one that writes: each answer is of the store
  /// as it is then. What the writer has in working memory alone is not seen, and nothing can be
  /// committed or subscribed to.
  bool is_read_only = false;
  /// What working memory may hold before its oldest snapshots leave for the store. More of it makes
  /// answers about the last minutes quicker. Unit: plain bytes.
  size_t max_working_bytes = size_t{512} << 20;
  /// Answer from latents where a snapshot has both forms: as it will be once what was recorded is
  /// dropped.
  bool prefers_latents = false;
  /// Notes in the store which snapshots are read, which is what forgetting goes by. Of one that is
  /// written to always.
  bool notes_reads = true;
  /// Predictions reach at most so far after the last snapshot.
  Duration max_horizon = std::chrono::minutes(1);
  /// Lossless compression and no filters, or the rules of a file: see docs/recording.md.
  std::filesystem::path recording_config{};
};

/// How a program reaches a memory server, or all servers of a robot.
struct ConnectOptions {
  /// The endpoint is that of a name system: what is asked and told goes to the servers that it
  /// knows, each memory to the one that has it, wherever they are and move to. An answer unites
  /// theirs; a server that is gone is looked for until the timeout.
  bool is_name_system = false;
  std::string token{};                          ///< Empty: none.
  std::filesystem::path ca{};                   ///< PEM: who vouches for servers elsewhere.
  Duration timeout = std::chrono::seconds(10);  ///< Of each call, retries included.
};

/// A memory: it remembers snapshots, says what was at any moment, and what will be.
///
///     ENGRAM_ASSIGN_OR_RETURN(auto memory, Memory::open("robot.engram"));
///     ENGRAM_ASSIGN_OR_RETURN(auto cup, ltm::MemoryId::parse("Objects/Things/kitchen/cup"));
///     ENGRAM_RETURN_IF_ERROR(memory->commit({{{cup, system_now(), {{idf::Dict{{"x", 0.4}}}}}}}));
///     ENGRAM_ASSIGN_OR_RETURN(auto past, memory->query("Objects @ last:10s"));
///     ENGRAM_ASSIGN_OR_RETURN(auto future, memory->query("Objects/Things/kitchen/cup @ +400ms"));
///
/// It is the same wherever it is: in a store that this program opens, in a server that other
/// programs use too, or in all servers of a robot. The same data give the same answers
/// (docs/query.md, section "Answers").
///
/// Threading: thread-safe.
/// Source: docs/cpp_api.md.
class Memory {
 public:
  /// Opens the store in a directory, and makes it where there is none (unless it is read alone).
  /// Errors: kFailedPrecondition where another process writes to it; kNotFound where there is none
  /// to read; kInvalidArgument where it is no store; kDataLoss.
  static Result<std::unique_ptr<Memory>> open(const std::filesystem::path& store,
                                              const OpenOptions& options = {});

  /// Reaches the memory server at an endpoint ("unix:/run/engram.sock", "host:4817"); empty: where
  /// this user's server listens by default. Does not wait for it: calls do, until their timeout.
  /// Errors: kInvalidArgument, as where a name system has no endpoint; kFailedPrecondition where
  /// this program was built without servers.
  static Result<std::unique_ptr<Memory>> connect(const std::string& endpoint = {},
                                                 const ConnectOptions& options = {});

  /// Closes it; what fails then is logged.
  virtual ~Memory() = default;

  /// Says what the values of a core segment (two names) or provider segment (three) are: commits
  /// are cast to that type where possible, and refused where not.
  /// Errors: kInvalidArgument where a provider's type does not extend the core type.
  virtual Status declare(const ltm::MemoryId& segment, const idf::Type& type) = 0;

  /// Remembers snapshots, all of them or none. After ok they can be asked for, and survive as much
  /// as `durability` says.
  /// Errors: kInvalidArgument naming every path where a value is not of its segment's type;
  /// kResourceExhausted where the disk is full or too much waits for it; kFailedPrecondition where
  /// it is opened for reading alone; kUnavailable: of a server; it may have arrived or not, and of
  /// the same entity and time a commit that comes twice counts once.
  virtual Status commit(const ltm::Commit& commit,
                        CommitDurability durability = CommitDurability::kDefault) = 0;

  /// Answers about past and future. `engine`: of predictions, by its name; empty: the best on each
  /// entity's own past.
  /// Errors: kNotFound where no entity matches; kInvalidArgument where a prediction is asked too
  /// far ahead; kResourceExhausted where the answer would be too large; kDataLoss.
  virtual Result<ltm::QueryResult> query(const ltm::Query& query,
                                         const std::string& engine = {}) = 0;

  /// The same of a query in its text form, docs/query.md.
  Result<ltm::QueryResult> query(std::string_view query, const std::string& engine = {});

  /// One prediction per horizon after the entity's last snapshot, in their order.
  /// Errors: those of query().
  Result<std::vector<ltm::SnapshotResult>> predict(const ltm::MemoryId& entity,
                                                   std::span<const Duration> horizons,
                                                   const std::string& engine = {});

  /// Everything that can predict an entity, with its error so far ahead on the entity's own past;
  /// what answers comes first.
  virtual Result<std::vector<ltm::EngineRecord>> engines(const ltm::MemoryId& entity,
                                                         Duration ahead) = 0;

  /// Tells of commits from now on, those of this program included. Returns when all is told.
  /// Errors: kInvalidArgument naming the pattern; kFailedPrecondition where it is opened for
  /// reading alone.
  virtual Result<std::unique_ptr<Subscription>> subscribe(const SubscriptionOptions& options,
                                                          SubscriptionHandlers handlers) = 0;

  /// Hands what working memory holds to the store and seals it; of a server, ends the connection.
  /// Errors: those of the store, with what could not be handed over. All other calls fail then.
  virtual Status close() = 0;
};

}  // namespace engram
