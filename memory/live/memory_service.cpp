// SPDX-License-Identifier: Apache-2.0
#include "memory/live/memory_service.h"

#include <algorithm>
#include <deque>
#include <future>
#include <thread>
#include <unordered_set>

#include "ltm/core/log.h"
#include "ltm/core/mutex.h"
#include "memory/live/redacted_commit.h"

namespace engram::memory {

using ltm::MemoryId;

namespace {

/// The bound of what is handed over at once. Unit: bytes.
constexpr size_t kHandedOver = size_t{32} << 20;

/// The bound of refused snapshots that are remembered for those who wait for them.
constexpr size_t kMaxRefused = 4096;

struct Waiter {
  uint64_t number = 0;
  ltm::Admission admission;
  std::function<void(const Status&)> done;
};

struct RefusedSnapshot {
  std::weak_ptr<const ltm::HeldSnapshot> snapshot;
  Status status;
};

}  // namespace

Status MemoryService::Options::validate() const {
  if (name.empty()) return invalid_argument("server: found an empty name, needs one");
  ENGRAM_RETURN_IF_ERROR(memory.validate());
  if (!store && memory.mode != ltm::StoreMode::kLatest)
    return invalid_argument(
        "server '{}': found no store, needs one for what leaves working memory, or a memory that "
        "may drop it",
        name);
  if (store_interval <= Duration(0))
    return invalid_argument("server '{}': store_interval: found {}, needs more than zero", name,
                            to_string(store_interval));
  return {};
}

struct MemoryService::State {
  State(const Options& given, Clock now) : options(given), clock(std::move(now)) {}

  const Options options;
  const Clock clock;
  std::unique_ptr<ltm::WorkingMemory> memory;
  std::shared_ptr<ltm::Redactor> redactor;  ///< Null if nothing is redacted.
  std::unique_ptr<LongTerm> store;          ///< Null without a store.
  Mutex recalling;                          ///< Held while `recall` answers: one query at a time.
  std::optional<ltm::Recall> recall ENGRAM_GUARDED_BY(recalling);
  const ltm::JoinedPast* past = nullptr;  ///< The past that `recall` answers from.
  ltm::Recall::Options recalling_options;
  ltm::RecordedEntities nothing_recorded;  ///< Stands in for LongTerm::recorded() without a store.

  std::atomic<uint64_t> queries{0};
  std::atomic<uint64_t> queries_of_store{0};
  std::atomic<uint64_t> counts_of_predictions{0};
  std::atomic<bool> is_closed{false};
  SharedMutex admitting;  ///< Commits hold it shared, close() exclusively.
  std::atomic<bool> is_forgetting{false};
  std::stop_source stops_forgetting;

  mutable Mutex mutex;
  StoppableCondition wake;
  std::vector<Waiter> waiters ENGRAM_GUARDED_BY(mutex);
  uint64_t last_waiter ENGRAM_GUARDED_BY(mutex) = 0;
  std::deque<RefusedSnapshot> refused ENGRAM_GUARDED_BY(mutex);  ///< The newest ones.
  /// The newest that were forgotten before they were stored. Apart, because many may go at once.
  std::deque<RefusedSnapshot> unstored ENGRAM_GUARDED_BY(mutex);
  uint64_t store_failures ENGRAM_GUARDED_BY(mutex) = 0;
  std::string last_store_failure ENGRAM_GUARDED_BY(mutex);
  bool has_handed_over_all ENGRAM_GUARDED_BY(mutex) = false;  ///< No waiter is told any more.
  std::jthread thread;  ///< The last member, so it ends first.

  /// Hands over everything that waits and tells the waiters.
  Status hand_over() ENGRAM_EXCLUDES(mutex) {
    Status status;
    // Waiters that come while this fails are told after the next try.
    const uint64_t until = [this] {
      const MutexLock lock(mutex);
      return last_waiter;
    }();
    while (status.ok()) {
      const auto sink = [this](std::span<const ltm::SharedSnapshot> snapshots) {
        return store ? record(snapshots) : Status();
      };
      const auto stored = memory->store(sink, kHandedOver);
      if (!stored.ok()) status = stored.status();
      if (stored.ok() && *stored == 0) break;
      tell(status, until);
    }
    tell(status, until);
    return status;
  }

  Status record(std::span<const ltm::SharedSnapshot> snapshots) ENGRAM_EXCLUDES(mutex) {
    std::vector<LongTerm::Refused> never;
    ENGRAM_RETURN_IF_ERROR(store->record(snapshots, never));
    const MutexLock lock(mutex);
    for (LongTerm::Refused& one : never) {
      log::warning("server '{}': '{}' is lost to the store: {}", options.name,
                   one.snapshot->id().to_string(), one.status.message());
      last_store_failure = one.status.message();
      refused.push_back({one.snapshot, std::move(one.status)});
      if (refused.size() > kMaxRefused) refused.pop_front();
    }
    return {};
  }

  /// The status of a commit that the online phase took.
  [[nodiscard]] Status outcome(const ltm::Admission& admission) const ENGRAM_REQUIRES(mutex) {
    // Compares owners, not pointers: a refused snapshot may be freed, and its address used again.
    for (const auto* known : {&refused, &unstored})
      for (const RefusedSnapshot& one : *known)
        for (const ltm::SharedSnapshot& snapshot : admission.snapshots)
          if (!one.snapshot.owner_before(snapshot) && !snapshot.owner_before(one.snapshot))
            return one.status;
    return {};
  }

  void tell(const Status& status, uint64_t until) ENGRAM_EXCLUDES(mutex) {
    const uint64_t taken = memory->taken();
    std::vector<std::pair<Waiter, Status>> told;
    {
      const MutexLock lock(mutex);
      if (!status.ok()) {
        ++store_failures;
        if (last_store_failure != status.message())
          log::warning("server '{}': {} snapshots wait, and could not be stored: {}", options.name,
                       memory->counters().waiting, status.to_string());
        last_store_failure = status.message();
      }
      std::erase_if(waiters, [&](Waiter& waiter) ENGRAM_REQUIRES(mutex) {
        const bool is_taken = waiter.admission.queued <= taken;
        if (!is_taken && (status.ok() || waiter.number > until)) return false;
        Status outcome =
            is_taken ? this->outcome(waiter.admission) : status.with_context("not stored yet");
        told.emplace_back(std::move(waiter), std::move(outcome));
        return true;
      });
    }
    for (const auto& [waiter, outcome] : told) waiter.done(outcome);
  }

  /// Tells those who wait for snapshots that were forgotten before they were stored.
  void tell_unstored(std::span<const ltm::SharedSnapshot> waited) ENGRAM_EXCLUDES(mutex) {
    std::unordered_set<const ltm::HeldSnapshot*> forgotten;
    for (const ltm::SharedSnapshot& one : waited) forgotten.insert(one.get());
    const Status status =
        cancelled("server '{}': it was forgotten before it was stored", options.name);
    std::vector<Waiter> told;
    {
      const MutexLock lock(mutex);
      // For those that are going to wait: commits that come just now.
      for (const ltm::SharedSnapshot& one : waited.last(std::min(waited.size(), kMaxRefused))) {
        unstored.push_back({one, status});
        if (unstored.size() > kMaxRefused) unstored.pop_front();
      }
      std::erase_if(waiters, [&](Waiter& waiter) {
        if (std::ranges::none_of(waiter.admission.snapshots, [&](const auto& snapshot) {
              return forgotten.contains(snapshot.get());
            }))
          return false;
        told.push_back(std::move(waiter));
        return true;
      });
    }
    for (const Waiter& waiter : told) waiter.done(status);
  }

  [[nodiscard]] ForgettingParts forgetting_parts() {
    return {
        .name = "server '" + options.name + "'",
        .memory = *memory,
        .store = store.get(),
        .path = options.store ? options.store->store : std::filesystem::path(),
        .tools = options.erasing,
        .ask =
            [this](const std::function<Status(ltm::Recall&)>& with) {
              const MutexLock lock(recalling);
              return with(*recall);
            },
        .unstored = [this](std::span<const ltm::SharedSnapshot> waited) { tell_unstored(waited); }};
  }

  /// Waits until nobody forgets any more.
  void stop_forgetting() {
    stops_forgetting.request_stop();
    is_forgetting.wait(true);
  }

  void run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      {
        const MutexLock lock(mutex);
        wake.wait_for(mutex, stop, options.store_interval,
                      [this]() ENGRAM_REQUIRES(mutex) { return !waiters.empty(); });
      }
      memory->expire();
      // The status is told to waiters and logged by hand_over().
      const Status status = hand_over();
      if (!status.ok()) {
        const MutexLock lock(mutex);
        wake.wait_for(mutex, stop, options.store_interval, [] { return false; });
      }
    }
  }

  /// Opens the store and what answers from it and from working memory.
  Status open_past(ltm::ModelLoader loader) {
    std::unique_ptr<ltm::StorePast> stored;
    std::unique_ptr<ltm::AccessLog> accesses;
    ltm::RecordedEntities* recorded = &nothing_recorded;
    if (options.store) {
      ENGRAM_ASSIGN_OR_RETURN(redactor, ltm::make_redactor(options.store->recording.rules));
      ENGRAM_ASSIGN_OR_RETURN(store, LongTerm::open(*options.store, clock, redactor));
      const std::filesystem::path& path = options.store->store;
      ENGRAM_ASSIGN_OR_RETURN(stored, ltm::StorePast::open(path, std::move(loader),
                                                           {options.store->max_decoded_bytes}));
      accesses = std::make_unique<ltm::AccessLog>(path, ltm::AccessLog::Options{});
      recorded = &store->recorded();
      const ltm::SegmentTypes types = store->types();
      for (const auto& [segment, type] : types.all())
        ENGRAM_RETURN_IF_ERROR(memory->declare(segment, type));
      recalling_options.prefer =
          options.store->prefers_latents ? ltm::Prefer::kLatent : ltm::Prefer::kRecorded;
      recalling_options.max_answer_bytes = options.store->max_answer_bytes;
    }
    recalling_options.max_horizon = options.max_horizon;
    ENGRAM_ASSIGN_OR_RETURN(auto joined,
                            ltm::JoinedPast::create("server '" + options.name + "'", *memory,
                                                    std::move(stored), *recorded));
    past = joined.get();
    const MutexLock lock(recalling);
    recall.emplace(std::move(joined), std::move(accesses));
    return {};
  }

  /// Counts the snapshots that were answered from working memory as read: this decides which may
  /// leave.
  void count_answer(const ltm::Answer& answer) {
    if (answer.is_ids_only) return;
    for (const ltm::RecalledEntity& entity : answer.entities) {
      size_t held = 0;
      for (const ltm::RecalledSnapshot& snapshot : entity.snapshots) {
        held += snapshot.held ? 1 : 0;
        if (snapshot.answer.source == ltm::Source::kPredicted) ++counts_of_predictions;
      }
      if (held > 0) memory->count_reads(entity.id, held);
    }
  }

  [[nodiscard]] ltm::KnownElsewhere elsewhere() const {
    if (!store) return {};
    return [this](const MemoryId& entity) { return store->recorded().known_until(entity); };
  }

  /// Whether the entities of a commit are known, or may become so. Those in working memory that the
  /// store has, too, are only taken out of the sum where that decides.
  [[nodiscard]] Status check_room(const ltm::Commit& commit) const {
    const ltm::RecordedEntities& recorded = store ? store->recorded() : nothing_recorded;
    size_t known = memory->entity_count() + recorded.size();
    if (known + commit.updates.size() <= options.max_entities) return {};
    size_t more = 0;
    bool is_exact = false;
    for (const ltm::EntityUpdate& update : commit.updates) {
      if (memory->has(update.entity) || recorded.contains(update.entity)) continue;
      if (known + ++more > options.max_entities && !is_exact) {
        for (const MemoryId& entity : memory->matching(ltm::Query()))
          if (recorded.contains(entity)) --known;
        is_exact = true;
      }
      if (known + more > options.max_entities)
        return resource_exhausted(
            "'{}' would be a new entity, and server '{}' has {} already, of at most {} "
            "(max_entities)",
            update.entity.to_string(), options.name, known, options.max_entities);
    }
    return {};
  }

  /// About what an answer with these moments takes. Unit: bytes.
  static size_t bytes_of(const ltm::SelectedEntity& selected, bool is_ids_only) {
    constexpr size_t kMoment = 256;
    size_t bytes = kMoment * (1 + selected.snapshots.size());
    if (!is_ids_only)
      for (const ltm::SharedSnapshot& snapshot : selected.snapshots)
        bytes += snapshot->plain_bytes();
    return bytes;
  }

  static ltm::RecalledEntity recalled(ltm::SelectedEntity& selected, bool is_ids_only) {
    ltm::RecalledEntity entity{std::move(selected.entity), {}};
    entity.snapshots.reserve(selected.snapshots.size());
    for (size_t i = 0; i < selected.snapshots.size(); ++i) {
      ltm::RecalledSnapshot one =
          ltm::recalled(std::move(selected.snapshots[i]), selected.instances[i], is_ids_only);
      if (!one.answer.instances.empty()) entity.snapshots.push_back(std::move(one));
    }
    return entity;
  }
};

MemoryService::MemoryService(std::unique_ptr<State> state) : state_(std::move(state)) {}

MemoryService::~MemoryService() {
  if (const Status status = close(); !status.ok())
    log::warning("server '{}': {}", state_->options.name, status.to_string());
}

Result<std::unique_ptr<MemoryService>> MemoryService::open(const Options& options,
                                                           ltm::ModelLoader loader, Clock clock) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  auto state = std::make_unique<State>(options, clock);
  ENGRAM_ASSIGN_OR_RETURN(state->memory, ltm::WorkingMemory::create(options.memory, clock));
  ENGRAM_RETURN_IF_ERROR(state->open_past(std::move(loader)));
  State& running = *state;
  state->thread = std::jthread([&running](const std::stop_token& stop) { running.run(stop); });
  return std::unique_ptr<MemoryService>(new MemoryService(std::move(state)));
}

const MemoryService::Options& MemoryService::options() const {
  return state_->options;
}

Status MemoryService::owns(const MemoryId& id) const {
  const auto& memories = state_->options.memories;
  if (memories.empty() || id.names().empty() ||
      std::ranges::find(memories, id.names()[0]) != memories.end())
    return {};
  return not_found("server '{}' has no memory '{}'; it has: {}", state_->options.name,
                   id.names()[0], fmt::join(memories, ", "));
}

Status MemoryService::declare(const MemoryId& segment, const idf::Type& type) {
  ENGRAM_RETURN_IF_ERROR(owns(segment));
  if (state_->store) ENGRAM_RETURN_IF_ERROR(state_->store->declare(segment, type));
  return state_->memory->declare(segment, type);
}

Result<ltm::Admission> MemoryService::commit(ltm::Commit commit,
                                             std::vector<std::vector<Buffer>> encoded,
                                             Durability durability) {
  const SharedLock admitting(state_->admitting);
  if (state_->is_closed) return unavailable("server '{}' is stopping", state_->options.name);
  for (const ltm::EntityUpdate& update : commit.updates)
    ENGRAM_RETURN_IF_ERROR(owns(update.entity));
  ENGRAM_RETURN_IF_ERROR(state_->check_room(commit));
  // Ahead of working memory, from which queries, subscribers, predictions and the store get it.
  ltm::WorkingMemory::Change redaction;
  if (state_->redactor)
    redaction = [this](ltm::Commit& cast, std::vector<std::vector<Buffer>>& bytes) {
      redact(*state_->redactor, cast, bytes);
    };
  return state_->memory->admit(std::move(commit), std::move(encoded),
                               durability == Durability::kJournal, redaction);
}

void MemoryService::when_stored(const ltm::Admission& admission,
                                std::function<void(const Status&)> done) {
  if (!state_->store) {
    done(failed_precondition("server '{}' has no store to make commits durable",
                             state_->options.name));
    return;
  }
  const uint64_t taken = state_->memory->taken();
  std::optional<Status> outcome;
  {
    const MutexLock lock(state_->mutex);
    if (admission.queued <= taken)
      outcome = state_->outcome(admission);
    else if (state_->has_handed_over_all)
      outcome = unavailable("server '{}' has stopped", state_->options.name);
    else
      state_->waiters.push_back({++state_->last_waiter, admission, std::move(done)});
  }
  if (outcome)
    done(*outcome);
  else
    state_->wake.notify_one();
}

Status MemoryService::wait_stored(const ltm::Admission& admission) {
  std::promise<Status> promise;
  when_stored(admission, [&promise](const Status& status) { promise.set_value(status); });
  return promise.get_future().get();
}

std::optional<ltm::Answer> MemoryService::query_memory(const ltm::Query& query, size_t max_bytes,
                                                       const ltm::View* view) {
  State& state = *state_;
  ltm::Answer answer{query.is_ids_only(), {}};
  auto selected = state.memory->select(query, state.elsewhere());
  size_t bytes = 0;
  for (ltm::SelectedEntity& entity : selected) {
    const ltm::Sight sight = ltm::sight_of(view, entity.entity);
    if (sight.times.empty()) continue;
    // What was selected of all moments is not what would be of some, and redacting takes long.
    if (!sight.is_whole()) return std::nullopt;
    if (entity.reaches_elsewhere || !entity.future.empty()) return std::nullopt;
    // Reading the sizes takes long where nobody wants to know.
    if (max_bytes != SIZE_MAX) bytes += State::bytes_of(entity, query.is_ids_only());
    if (bytes > max_bytes) return std::nullopt;
    answer.entities.push_back(State::recalled(entity, query.is_ids_only()));
  }
  if (answer.entities.empty()) return std::nullopt;
  if (state.store)
    for (const MemoryId& entity : state.store->recorded().matching(query))
      if (!std::ranges::binary_search(answer.entities, entity, {}, &ltm::RecalledEntity::id) &&
          !ltm::sight_of(view, entity).times.empty())
        return std::nullopt;
  ++state.queries;
  state.count_answer(answer);
  return answer;
}

Result<ltm::Answer> MemoryService::query(const ltm::Query& query, const std::string& engine) {
  if (engine.empty())
    if (auto answer = query_memory(query)) return *std::move(answer);
  State& state = *state_;
  ++state.queries;
  ++state.queries_of_store;
  ltm::Recall::Options options = state.recalling_options;
  options.engine = engine;
  const MutexLock lock(state.recalling);
  auto answer = state.recall->answer(query, options);
  if (answer.ok()) state.count_answer(*answer);
  return answer;
}

Result<ltm::Recall::AnswerCursor> MemoryService::begin_query(const ltm::Query& query,
                                                             const std::string& engine,
                                                             ltm::SharedView view) {
  State& state = *state_;
  ++state.queries;
  ++state.queries_of_store;
  ltm::Recall::Options options = state.recalling_options;
  options.engine = engine;
  options.view = std::move(view);
  const MutexLock lock(state.recalling);
  return state.recall->begin(query, options);
}

Result<ltm::Answer> MemoryService::next_part(ltm::Recall::AnswerCursor& cursor, size_t bytes) {
  const MutexLock lock(state_->recalling);
  auto part = state_->recall->next(cursor, bytes);
  if (part.ok()) state_->count_answer(*part);
  return part;
}

Result<std::vector<ltm::SnapshotResult>> MemoryService::predict(
    const MemoryId& entity, const ltm::PredictionRequest& request, ltm::SharedView view) {
  State& state = *state_;
  ++state.queries;
  ++state.queries_of_store;
  ltm::Recall::Options options = state.recalling_options;
  options.view = std::move(view);
  const MutexLock lock(state.recalling);
  auto predicted = state.recall->predict(entity, request, options);
  if (predicted.ok()) state.counts_of_predictions += predicted->size();
  return predicted;
}

Result<std::vector<ltm::EngineRecord>> MemoryService::engines(const MemoryId& entity,
                                                              Duration ahead,
                                                              std::optional<Time> at,
                                                              ltm::SharedView view) {
  ltm::Recall::Options options = state_->recalling_options;
  options.view = std::move(view);
  const MutexLock lock(state_->recalling);
  return state_->recall->records(entity, at, ahead, options);
}

bool MemoryService::may_redact_in(std::string_view memory) const {
  return state_->redactor && state_->redactor->may_apply_in(memory);
}

Result<ForgetOutcome> MemoryService::forget(ForgetRequest request) {
  State& state = *state_;
  if (state.is_forgetting.exchange(true))
    return failed_precondition("server '{}' is forgetting already: ask again when it has ended",
                               state.options.name);
  struct Ended {
    std::atomic<bool>& is_forgetting;
    ~Ended() {
      is_forgetting = false;
      is_forgetting.notify_all();
    }
  };
  const Ended ended{state.is_forgetting};
  if (state.is_closed) return unavailable("server '{}' is stopping", state.options.name);
  std::stop_source stop;
  const auto request_stop = [&stop] { stop.request_stop(); };
  const std::stop_callback by_caller(std::exchange(request.stop, stop.get_token()), request_stop);
  const std::stop_callback by_close(state.stops_forgetting.get_token(), request_stop);
  return forget_live(state.forgetting_parts(), request);
}

MemoryService::Counters MemoryService::counters() const {
  Counters counters;
  if (state_->redactor) counters.redaction = state_->redactor->counters();
  counters.memory = state_->memory->counters();
  if (state_->store) counters.store = state_->store->counters();
  if (state_->past->store() != nullptr) counters.reading = state_->past->store()->counters();
  counters.queries = state_->queries;
  counters.queries_of_store = state_->queries_of_store;
  counters.predictions = state_->counts_of_predictions;
  const MutexLock lock(state_->mutex);
  counters.store_failures = state_->store_failures;
  counters.last_store_failure = state_->last_store_failure;
  return counters;
}

Status MemoryService::set_limits(const ltm::MemoryLimits& all) {
  return state_->memory->set_limits(all);
}

Status MemoryService::close() {
  State& state = *state_;
  if (state.is_closed.exchange(true)) return {};
  state.stop_forgetting();
  state.thread.request_stop();
  state.thread.join();
  // Waits for the commits that had passed their check before is_closed was set.
  { const ExclusiveLock last_commits(state.admitting); }
  state.memory->release_all();
  Status status = state.hand_over();
  {
    const MutexLock lock(state.mutex);
    state.has_handed_over_all = true;
  }
  // For waiters that came after the last ones were told.
  state.tell(status, UINT64_MAX);
  if (!status.ok())
    return status.with_context(
        fmt::format("{} snapshots of working memory are lost", state.memory->counters().waiting));
  return state.store ? state.store->close() : Status();
}

}  // namespace engram::memory
