// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "ltm/recall/joined_past.h"
#include "ltm/recall/recall.h"
#include "ltm/working/working_memory.h"
#include "memory/live/long_term.h"

namespace engram::memory {

/// One server's memories: working memory, the store below it, and predictions. Knows no network.
///
/// A query is answered from working memory where that alone can tell, else from both.
/// Threading: thread-safe; has a thread of its own that hands over to the online phase.
/// Source: docs/server.md.
class MemoryService {
 public:
  struct Options {
    std::string name = "engram";  ///< Of the server; unique among those of a robot.
    /// First names of the IDs that it takes; empty: any.
    std::vector<std::string> memories;
    ltm::WorkingMemory::Options memory;
    /// Without a store, what leaves working memory is gone: needs ltm::StoreMode::kLatest then.
    std::optional<LongTerm::Options> store;
    /// How often what waits is handed over; commits that wait for it are at once.
    Duration store_interval = std::chrono::milliseconds(200);
    /// Predictions reach at most so far.
    Duration max_horizon = std::chrono::minutes(1);

    [[nodiscard]] Status validate() const;
  };

  /// What is needed of an acknowledged commit.
  enum class Durability : uint8_t {
    kMemory,   ///< Others can read it.
    kJournal,  ///< And it survives `kill -9`, as far as the filters keep it.
  };

  struct Counters {
    ltm::MemoryCounters memory;
    std::optional<LongTerm::Counters> store;
    ltm::StorePast::Counters reading{};  ///< Of the store; zeros without one.
    uint64_t queries = 0;
    uint64_t queries_of_store = 0;  ///< That working memory alone could not answer.
    uint64_t predictions = 0;
    uint64_t store_failures = 0;  ///< Attempts to hand over; what waits stays.
    std::string last_store_failure;
  };

  /// `loader` opens models; null: latents cannot be decoded.
  /// Errors: kInvalidArgument; those of LongTerm::open.
  static Result<std::unique_ptr<MemoryService>> open(const Options& options,
                                                     ltm::ModelLoader loader,
                                                     Clock clock = system_now);
  /// Hands over what it can; see close().
  ~MemoryService();

  [[nodiscard]] const Options& options() const;

  /// Errors: kNotFound where the ID is of no memory of this server.
  [[nodiscard]] Status owns(const ltm::MemoryId& id) const;

  /// See ltm::WorkingMemory::declare and ltm::Recorder::declare.
  Status declare(const ltm::MemoryId& segment, const idf::Type& type);

  /// See ltm::WorkingMemory::admit. After ok it can be read; with Durability::kJournal it is
  /// durable when when_stored() says so.
  Result<ltm::Admission> commit(ltm::Commit commit, std::vector<std::vector<Buffer>> encoded = {},
                                Durability durability = Durability::kMemory);

  /// Calls `done` once, from any thread, when the online phase has what was queued until then, or
  /// could not take it: then it still waits, and is tried again; kInvalidArgument where the store
  /// will never take it.
  void when_stored(const ltm::Admission& admission, std::function<void(const Status&)> done);

  /// The same, waiting.
  Status wait_stored(const ltm::Admission& admission);

  /// The answer if working memory alone can tell it; that takes microseconds.
  [[nodiscard]] std::optional<ltm::Answer> query_memory(const ltm::Query& query);

  /// Any query. May take as long as decoding takes. `engine`: of predictions; empty: the best.
  /// Errors: those of ltm::Recall::answer.
  Result<ltm::Answer> query(const ltm::Query& query, const std::string& engine = {});

  /// What predicts an entity, measured that far ahead; the one that answers first.
  Result<std::vector<ltm::EngineRecord>> engines(const ltm::MemoryId& entity, Duration ahead);

  [[nodiscard]] Counters counters() const;

  /// See ltm::WorkingMemory::set_limits.
  Status set_limits(const ltm::MemoryLimits& all);

  /// Hands everything over and seals the store. Commits are refused from then on.
  /// Errors: those of the store: what could not be handed over is named.
  Status close();

 private:
  struct State;
  explicit MemoryService(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace engram::memory
