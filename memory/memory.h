// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/core/time.h"
#include "ltm/idf/type.h"
#include "ltm/likeness/moment_map.h"
#include "ltm/likeness/similar_moments.h"
#include "ltm/memory/commit.h"
#include "ltm/memory/query.h"
#include "ltm/memory/result.h"
#include "ltm/prediction/engine_choice.h"
#include "ltm/saliency/salient_moment.h"
#include "memory/live/subscription.h"
#include "memory/replay/replay_options.h"

namespace engram {

/// When a commit is acknowledged.
enum class CommitDurability : uint8_t {
  /// For a memory that this program opened: kJournal. For a server: what the server is configured
  /// for.
  kDefault,
  kMemory,   ///< As soon as others can read it.
  kJournal,  ///< When it survives a killed process, as far as the filters keep it.
};

/// How a program opens a memory of its own.
struct OpenOptions {
  /// Opens the store for queries alone. Any number of programs may read it beside the one that
  /// writes, and each answer shows the store as it is at that moment. Such a memory does not see
  /// what the writer holds in working memory only, and it accepts no commits and no subscriptions.
  bool is_read_only = false;
  /// The bound of working memory: beyond it the oldest snapshots leave for the store. A larger
  /// bound makes queries about the last minutes faster. Unit: plain bytes.
  size_t max_working_bytes = size_t{512} << 20;
  /// Answers from latents where a snapshot has both forms. This shows the answers as they will be
  /// once the recorded form is dropped.
  bool prefers_latents = false;
  /// Notes in the store which snapshots are read; forgetting goes by these notes. A memory that is
  /// open for writing always notes them.
  bool notes_reads = true;
  /// How far after the last snapshot predictions may reach. Longer horizons are refused.
  Duration max_horizon = std::chrono::minutes(1);
  /// A file of recording rules, see docs/recording.md. Empty: lossless compression and no filters.
  std::filesystem::path recording_config{};
};

/// How a program reaches a memory server, or all servers of a robot.
struct ConnectOptions {
  /// The endpoint is that of a name system. Each call then goes to the servers that the name system
  /// knows, and for each memory to the server that owns it, also after that memory has moved. An
  /// answer unites the answers of all servers. A server that is down is retried until the timeout.
  bool is_name_system = false;
  std::string token{};  ///< Authenticates this program; empty: no token.
  /// A PEM file with the certificate authority of servers on other machines.
  std::filesystem::path ca{};
  Duration timeout = std::chrono::seconds(10);  ///< For each call, retries included.
};

/// How Memory::predict predicts.
struct PredictOptions {
  /// The moment to predict from: the prediction is made from the snapshots up to it alone, as it
  /// would have been made then. Empty: the newest snapshot.
  std::optional<Time> at{};
  /// The entity whose snapshots after that moment tell where the entity is going to be that a model
  /// is conditioned on: planned joints for a camera. Then the model alone predicts. If nothing is
  /// planned after that moment, the prediction is made without it, and names no plan. Empty: none.
  std::optional<ltm::MemoryId> plan{};
  /// The name of the engine that predicts. Empty: the one that was best on the entity's own past,
  /// for each horizon and member.
  std::string engine{};
};

/// A memory. It stores snapshots and answers queries about any moment of the past and the future.
///
///     ENGRAM_ASSIGN_OR_RETURN(auto memory, Memory::open("robot.engram"));
///     ENGRAM_ASSIGN_OR_RETURN(auto cup, ltm::MemoryId::parse("Objects/Things/kitchen/cup"));
///     ENGRAM_RETURN_IF_ERROR(memory->commit({{{cup, system_now(), {{idf::Dict{{"x", 0.4}}}}}}}));
///     ENGRAM_ASSIGN_OR_RETURN(auto past, memory->query("Objects @ last:10s"));
///     ENGRAM_ASSIGN_OR_RETURN(auto future, memory->query("Objects/Things/kitchen/cup @ +400ms"));
///
/// The interface is the same for a store that this program opens, for a server that other programs
/// use too, and for all servers of a robot. The same data give the same answers in all three
/// (docs/query.md, section "Answers").
///
/// Threading: thread-safe.
/// Source: docs/cpp_api.md.
class Memory {
 public:
  /// Opens the store in a directory. It creates the store if there is none, unless it is opened for
  /// reading alone.
  /// Errors: kFailedPrecondition where another process writes to it; kNotFound where it is opened
  /// for reading and there is none; kInvalidArgument where the directory is no store; kDataLoss.
  static Result<std::unique_ptr<Memory>> open(const std::filesystem::path& store,
                                              const OpenOptions& options = {});

  /// Reaches the memory server at an endpoint ("unix:/run/engram.sock", "host:4817"). Empty: the
  /// address where this user's server listens by default. Does not wait for the server; the calls
  /// do, until their timeout.
  /// Errors: kInvalidArgument, also where a name system has no endpoint; kFailedPrecondition where
  /// this program was built without servers.
  static Result<std::unique_ptr<Memory>> connect(const std::string& endpoint = {},
                                                 const ConnectOptions& options = {});

  /// Opens a store as the memory that it was at a moment, on a clock of its own. Whoever asks it is
  /// answered as it was then, `latest` and predictions included; whoever subscribes is told what
  /// came, in the recorded order. What is committed is there until the replay jumps to a moment
  /// before it, or is closed; nothing is written to the store. memory/replay_control.h controls it.
  /// Errors: kInvalidArgument where `options.at` lies before the first snapshot, where the store
  /// has none, or for options that do not validate; kNotFound where there is no store; kDataLoss.
  /// Source: docs/replay.md.
  static Result<std::unique_ptr<Memory>> replay(const std::filesystem::path& store,
                                                const ReplayOptions& options);

  /// Closes the memory. An error of closing is logged.
  virtual ~Memory() = default;

  /// Sets the type of the values of a core segment (two names) or provider segment (three names).
  /// Commits are cast to that type where possible, and refused otherwise.
  /// Errors: kInvalidArgument where a provider's type does not extend the core type.
  virtual Status declare(const ltm::MemoryId& segment, const idf::Type& type) = 0;

  /// Stores snapshots, all of them or none. Once this returns ok they can be queried, and they
  /// survive as much as `durability` promises.
  /// Errors: kInvalidArgument naming every path where a value is not of its segment's type;
  /// kResourceExhausted where the disk is full or too many bytes wait for it; kFailedPrecondition
  /// where the memory is opened for reading alone; kUnavailable, only from a server: the commit may
  /// have arrived or not. It is safe to send it again, because a second commit of the same entity
  /// and time counts once.
  virtual Status commit(const ltm::Commit& commit,
                        CommitDurability durability = CommitDurability::kDefault) = 0;

  /// Answers a query about the past and the future. `engine` names the engine of predictions;
  /// empty: the one that was best on each entity's own past.
  /// Errors: kNotFound where no entity matches; kInvalidArgument where a horizon is too long;
  /// kResourceExhausted where the answer would be too large; kDataLoss.
  virtual Result<ltm::QueryResult> query(const ltm::Query& query,
                                         const std::string& engine = {}) = 0;

  /// The same in parts of about a quarter of a megabyte, so that neither this program nor a server
  /// has to hold all of a large answer. Entities come in order; one with much comes in several
  /// parts, one after the other. The servers of a name system come one after the other, too, each
  /// with its memories. `visit` is called by this thread, and must not ask this memory. Its error
  /// ends the answer and is returned.
  /// Errors: those of query() and of `visit`. Parts may have been visited before an error.
  using PartVisit = std::function<Status(ltm::QueryResult part)>;
  virtual Status query_parts(const ltm::Query& query, const PartVisit& visit,
                             const std::string& engine = {});

  /// Parses a query in its text form (docs/query.md) and answers it.
  Result<ltm::QueryResult> query(std::string_view query, const std::string& engine = {});

  /// Returns one prediction per horizon, in the order of the horizons. They count from the last
  /// snapshot at or before `options.at`.
  /// Errors: those of query(); kNotFound also where there is no snapshot to predict from, no such
  /// engine, or the plan is no entity of this memory (of the same server, where a robot has
  /// several); kInvalidArgument also where nothing that predicts the entity can be told a plan;
  /// kFailedPrecondition where `at` or `plan` is set and the server is of an earlier version.
  Result<std::vector<ltm::SnapshotResult>> predict(const ltm::MemoryId& entity,
                                                   std::span<const Duration> horizons,
                                                   const PredictOptions& options = {});

  /// The same from the newest snapshot, by one engine.
  Result<std::vector<ltm::SnapshotResult>> predict(const ltm::MemoryId& entity,
                                                   std::span<const Duration> horizons,
                                                   const std::string& engine);

  /// Lists all engines that can predict an entity, each with its error at this horizon on the
  /// entity's own past. The engine that answers queries is first. With `at` all is as of that
  /// moment, and nothing after it is looked at.
  /// Errors: kNotFound if there is no moment up to `at`; kFailedPrecondition if `at` is set and the
  /// server is of an earlier version.
  virtual Result<std::vector<ltm::EngineRecord>> engines(const ltm::MemoryId& entity,
                                                         Duration ahead,
                                                         std::optional<Time> at) = 0;
  Result<std::vector<ltm::EngineRecord>> engines(const ltm::MemoryId& entity, Duration ahead) {
    return engines(entity, ahead, {});
  }

  /// Finds the moments of an entity that are like one of its moments, or like an image: when was it
  /// like this before? What is in the store is compared, and what working memory holds. Codes of
  /// one entity alone are comparable, so with a name system the server that has the entity answers;
  /// entities beside it need to be in the same server.
  /// Errors: those of ltm::LikenessSearch::find; kFailedPrecondition also if a server is of an
  /// earlier version or has no store; kInvalidArgument also if more than 10,000 moments or 16
  /// other entities are asked of a server; kUnavailable also if it took longer than the timeout:
  /// what was coded until then is kept, so asking again goes on.
  virtual Result<ltm::SimilarAnswer> similar(const ltm::SimilarRequest& request) = 0;

  /// At most `max_moments` moments of an entity in two dimensions, evenly spread: those that are
  /// like each other are near.
  /// Errors: those of ltm::LikenessSearch::map; kFailedPrecondition if this memory is in a server,
  /// which does not answer this.
  virtual Result<ltm::MomentMap> map(const ltm::MemoryId& entity, size_t max_moments);

  /// Explains what the snapshot of an entity at `time` is worth; without a time, its last one. What
  /// is in the store is explained, journals included.
  /// Errors: those of ltm::why_salient; kFailedPrecondition if this memory is in a server, which
  /// does not answer this.
  virtual Result<ltm::SalientMoment> why_salient(const ltm::MemoryId& entity,
                                                 std::optional<Time> time);
  Result<ltm::SalientMoment> why_salient(const ltm::MemoryId& entity) {
    return why_salient(entity, {});
  }

  /// Subscribes to the commits from now on, those of this program included. Returns once the
  /// subscription is in place.
  /// Errors: kInvalidArgument naming the pattern; kFailedPrecondition where the memory is opened
  /// for reading alone.
  virtual Result<std::unique_ptr<Subscription>> subscribe(const SubscriptionOptions& options,
                                                          SubscriptionHandlers handlers) = 0;

  /// Hands what working memory holds to the store and seals it; for a server, ends the connection.
  /// All other calls fail afterwards.
  /// Errors: those of the store, with what could not be handed over.
  virtual Status close() = 0;

 private:
  /// Predicts from a moment or with a plan. `entity` and `horizons` are valid.
  virtual Result<std::vector<ltm::SnapshotResult>> predict_from(const ltm::MemoryId& entity,
                                                                std::span<const Duration> horizons,
                                                                const PredictOptions& options) = 0;
};

}  // namespace engram
