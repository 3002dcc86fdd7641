// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ltm/likeness/moment_map.h"
#include "ltm/likeness/similar_moments.h"
#include "ltm/recall/joined_past.h"
#include "ltm/recall/recall.h"
#include "ltm/working/working_memory.h"
#include "memory/live/live_forgetting.h"
#include "memory/live/long_term.h"
#include "memory/live/past_below.h"
#include "memory/live/sensory_memory.h"

namespace engram::memory {

/// The memories of one server: working memory, the store below it, and predictions. It knows no
/// network.
///
/// A query is answered from working memory if that alone can answer it, otherwise from both.
/// Threading: thread-safe; a thread of its own hands snapshots to the online phase.
/// Source: docs/server.md.
class MemoryService {
 public:
  struct Options {
    std::string name = "engram";  ///< The name of the server; unique among those of a robot.
    /// The memories (first names of IDs) that it accepts; empty: any.
    std::vector<std::string> memories;
    ltm::WorkingMemory::Options memory;
    /// Without a store, what leaves working memory is lost; this needs ltm::StoreMode::kLatest.
    std::optional<LongTerm::Options> store;
    /// In place of a store: a past that nobody adds to. Its clock is that of the service.
    std::shared_ptr<PastBelow> below{};
    /// What LongTerm::Options says of a store, for `below`: rules, of which those that redact apply
    /// to commits, and the bound of one answer.
    std::vector<ltm::EntityRule> redacting{};
    size_t max_answer_bytes = LongTerm::Options().max_answer_bytes;
    /// How often waiting snapshots are handed over. Durable commits do not wait for it.
    Duration store_interval = std::chrono::milliseconds(200);
    /// Max number of entities that the memory knows, those of the store included: each costs RAM as
    /// long as the server runs, wherever its snapshots are. Commits of further ones are refused.
    size_t max_entities = 1'000'000;
    /// Which entities precede working memory in sensory memory. A past in place of a store has
    /// none.
    SensoryMemory::Options sensory;
    /// What erasing needs of the rooms that learn; empty: a store with models cannot be erased
    /// from.
    EraseTools erasing;
    /// How far after the last snapshot predictions may reach.
    Duration max_horizon = std::chrono::minutes(1);

    [[nodiscard]] Status validate() const;
  };

  /// What holds for a commit once it is acknowledged.
  enum class Durability : uint8_t {
    kMemory,   ///< Others can read it.
    kJournal,  ///< It also survives `kill -9`, as far as the filters keep it.
  };

  struct Counters {
    ltm::MemoryCounters memory;
    std::optional<LongTerm::Counters> store;
    /// Counters of reading the store; zero without one.
    ltm::StorePast::Counters reading{};
    uint64_t queries = 0;
    uint64_t queries_of_store = 0;  ///< Queries that working memory alone could not answer.
    uint64_t predictions = 0;
    ltm::RedactionCounters redaction{};
    std::optional<SensoryCounts> sensory;  ///< Nothing where nothing is sensory.
    uint64_t store_failures = 0;           ///< Failed attempts to hand over; what waits stays.
    std::string last_store_failure;
  };

  /// `loader` opens models; without it latents cannot be decoded.
  /// Errors: kInvalidArgument; those of LongTerm::open.
  static Result<std::unique_ptr<MemoryService>> open(const Options& options,
                                                     ltm::ModelLoader loader,
                                                     Clock clock = system_now);
  /// Hands over what it can; see close().
  ~MemoryService();

  [[nodiscard]] const Options& options() const;

  /// Errors: kNotFound where no memory of this server has the ID.
  [[nodiscard]] Status owns(const ltm::MemoryId& id) const;

  /// See ltm::WorkingMemory::declare and ltm::Recorder::declare.
  Status declare(const ltm::MemoryId& segment, const idf::Type& type);

  /// Redacts images where a recording rule says so (ltm::Redactor); a snapshot that it drops is
  /// counted and is not admitted, without an error. Then see ltm::WorkingMemory::admit;
  /// kResourceExhausted also beyond `max_entities`. After ok the commit can be read; with
  /// Durability::kJournal it is durable once when_stored() says so.
  Result<ltm::Admission> commit(ltm::Commit commit, std::vector<std::vector<Buffer>> encoded = {},
                                Durability durability = Durability::kMemory);

  /// Holds those updates in sensory memory that may be lost, and leaves the others in the commit:
  /// see SensoryMemory::hold. To be called ahead of commit(), unless the commit must not be lost.
  /// Errors: kNotFound where no memory of this server has the ID; those of SensoryMemory::hold.
  Status hold(ltm::Commit& commit, std::vector<std::vector<Buffer>>& encoded);

  /// Opens attention to sensory entities for as long as the result lives, see
  /// SensoryMemory::attend. What queries select is attended to without this. The second form is for
  /// the entities that a pattern names ("Vision/.*/head/cam").
  /// Errors: kInvalidArgument naming the pattern.
  [[nodiscard]] Attention attend(SensoryMemory::Wanted is_wanted);
  Result<Attention> attend(const std::string& names);

  /// Whether a query may have to wait until what sensory memory holds has passed. A thread that
  /// must not wait asks this ahead of it.
  [[nodiscard]] bool may_wait_for_sensory(const ltm::Query& query, const ltm::View* view) const;

  /// Sensory memory, for who has sources of his own; null where nothing is sensory.
  [[nodiscard]] const std::shared_ptr<SensoryMemory>& sensory() const;

  /// Sets who is told of what passes from sensory memory to working memory. Call it before anything
  /// is committed.
  using TellPassed = std::function<void(std::span<const ltm::SharedSnapshot> snapshots)>;
  void tell_of_passed(TellPassed tell);

  /// Calls `done` once, from any thread, when the online phase has everything that was queued until
  /// `admission`, or failed to take it. After a failure it still waits and is tried again. The
  /// status is kInvalidArgument where the store will never take it.
  void when_stored(const ltm::Admission& admission, std::function<void(const Status&)> done);

  /// Waits for the status of when_stored().
  Status wait_stored(const ltm::Admission& admission);

  /// The answer, if working memory alone can give it and it has at most `max_bytes`. Takes
  /// microseconds.
  [[nodiscard]] std::optional<ltm::Answer> query_memory(const ltm::Query& query,
                                                        size_t max_bytes = SIZE_MAX,
                                                        const ltm::View* view = nullptr);

  // Here and below, `view` is what may be seen by who asks; null: everything.

  /// Answers any query. May take as long as decoding takes. `engine` names the engine of
  /// predictions; empty: the best.
  /// Errors: those of ltm::Recall::answer.
  Result<ltm::Answer> query(const ltm::Query& query, const std::string& engine = {});

  /// The same in parts, see ltm::Recall::begin and next. Other questions are answered in between.
  /// `others` are contexts of entities of other memories that conditions name.
  Result<ltm::Recall::AnswerCursor> begin_query(
      const ltm::Query& query, const std::string& engine, ltm::SharedView view = {},
      std::shared_ptr<const ltm::OtherContexts> others = {});
  Result<ltm::Answer> next_part(ltm::Recall::AnswerCursor& cursor, size_t bytes);

  /// The context of an entity for who asks another memory, see ltm::Recall::context.
  Result<ltm::SharedContext> context(const ltm::MemoryId& entity, const ltm::SharedView& view);

  /// Predicts from a moment on, or with a plan.
  /// Errors: those of ltm::Recall::predict.
  Result<std::vector<ltm::SnapshotResult>> predict(const ltm::MemoryId& entity,
                                                   const ltm::PredictionRequest& request,
                                                   ltm::SharedView view = {});

  /// The engines that can predict an entity, measured at this horizon; the one that answers is
  /// first. With `at` as of that moment.
  Result<std::vector<ltm::EngineRecord>> engines(const ltm::MemoryId& entity, Duration ahead,
                                                 std::optional<Time> at, ltm::SharedView view = {});

  /// Finds the moments of an entity that are like another one, in working memory and in the store.
  /// Questions take turns, and hold up no others.
  /// Errors: those of ltm::StoreLikeness::similar; kFailedPrecondition without a store.
  Result<ltm::SimilarAnswer> similar(const ltm::SimilarRequest& request, ltm::SharedView view = {},
                                     const std::stop_token& stop = {});

  /// At most `max_moments` moments of an entity in two dimensions, of all that there are: no view
  /// hides any.
  /// Errors: those of ltm::StoreLikeness::map; kFailedPrecondition without a store.
  Result<ltm::MomentMap> map(const ltm::MemoryId& entity, size_t max_moments);

  /// Whether images of a memory may be redacted. What others may read as it comes, such as shared
  /// memory, must not be used for it.
  [[nodiscard]] bool may_redact_in(std::string_view memory) const;

  /// See forget_live(). Those who wait for commits that were never stored are told kCancelled.
  /// close() stops it.
  /// Errors: kFailedPrecondition while another call forgets; kUnavailable once it is closed; those
  /// of forget_live().
  Result<ForgetOutcome> forget(ForgetRequest request);

  [[nodiscard]] Counters counters() const;

  /// See ltm::WorkingMemory::set_limits.
  Status set_limits(const ltm::MemoryLimits& all);

  /// Sets who is told of what happens in Options::below, see PastBelow::tell. Nothing without it.
  void tell_of_below(PastListener listener);

  /// Hands everything over and seals the store. Commits are refused from then on.
  /// Errors: those of the store, with the number of snapshots that could not be handed over.
  Status close();

 private:
  struct State;
  /// Commits what sensory memory held, and tells who is told of it.
  Status pass(ltm::Commit commit, std::vector<std::vector<Buffer>> encoded);
  explicit MemoryService(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace engram::memory
