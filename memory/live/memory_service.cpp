// SPDX-License-Identifier: Apache-2.0
#include "memory/live/memory_service.h"

#include <algorithm>
#include <future>
#include <thread>

#include "ltm/core/log.h"
#include "memory/live/memory_service_state.h"
#include "memory/live/redacted_commit.h"

namespace engram::memory {

using ltm::MemoryId;

Status MemoryService::Options::validate() const {
  if (name.empty()) return invalid_argument("server: found an empty name, needs one");
  ENGRAM_RETURN_IF_ERROR(memory.validate());
  ENGRAM_RETURN_IF_ERROR(sensory.validate());
  if (below && !sensory.segments.empty())
    return invalid_argument("server '{}': found sensory segments beside a past, needs none", name);
  if (store && below)
    return invalid_argument("server '{}': found a store and a past in place of one, needs one",
                            name);
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

MemoryService::MemoryService(std::unique_ptr<State> state) : state_(std::move(state)) {}

MemoryService::~MemoryService() {
  if (const Status status = close(); !status.ok())
    log::warning("server '{}': {}", state_->options.name, status.to_string());
}

Result<std::unique_ptr<MemoryService>> MemoryService::open(const Options& options,
                                                           ltm::ModelLoader loader, Clock clock) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  if (options.below) clock = options.below->clock();
  auto state = std::make_unique<State>(options, clock);
  ltm::WorkingMemory::Options held = options.memory;
  // Programs stamp with clocks of their own, which know nothing of one that was set.
  if (options.below) held.ahead = {.all = ltm::AheadLimits::kNone, .parts = {}};
  ENGRAM_ASSIGN_OR_RETURN(state->memory, ltm::WorkingMemory::create(held, clock));
  ENGRAM_RETURN_IF_ERROR(state->open_past(std::move(loader)));
  State& running = *state;
  auto service = std::unique_ptr<MemoryService>(new MemoryService(std::move(state)));
  if (!options.sensory.segments.empty())
    running.sensory = SensoryMemory::create(
        options.sensory, options.max_entities,
        [passing = service.get()](ltm::Commit commit, std::vector<std::vector<Buffer>> encoded) {
          return passing->pass(std::move(commit), std::move(encoded));
        },
        clock);
  running.thread = std::jthread([&running](const std::stop_token& stop) { running.run(stop); });
  return service;
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
  ENGRAM_RETURN_IF_ERROR(state_->room->admit(commit));
  PastBelow* const below = state_->options.below.get();
  if (below != nullptr) ENGRAM_RETURN_IF_ERROR(below->check(commit));
  // Ahead of working memory, from which queries, subscribers, predictions and the store get it.
  ltm::WorkingMemory::Change redaction;
  if (state_->redactor)
    redaction = [this](ltm::Commit& cast, std::vector<std::vector<Buffer>>& bytes) {
      redact(*state_->redactor, cast, bytes);
    };
  auto admission = state_->memory->admit(std::move(commit), std::move(encoded),
                                         durability == Durability::kJournal, redaction);
  if (below != nullptr && admission.ok()) ENGRAM_RETURN_IF_ERROR(below->admitted(*admission));
  return admission;
}

void MemoryService::when_stored(const ltm::Admission& admission,
                                std::function<void(const Status&)> done) {
  if (state_->options.below) {
    done({});  // It ends with the process, and programs must not notice.
    return;
  }
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

bool MemoryService::may_redact_in(std::string_view memory) const {
  return state_->redactor && state_->redactor->may_apply_in(memory);
}

Result<ForgetOutcome> MemoryService::forget(ForgetRequest request) {
  State& state = *state_;
  if (state.options.below)
    return failed_precondition(
        "server '{}': is a replay, which changes nothing of what was recorded; forget from the "
        "store itself",
        state.options.name);
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
  auto outcome = forget_live(state.forgetting_parts(), request);
  // Codes tell of what is gone, also where an error came after some of it went.
  if (state.likeness && !request.is_dry_run) state.likeness->forget_codes();
  return outcome;
}

MemoryService::Counters MemoryService::counters() const {
  Counters counters;
  if (state_->redactor) counters.redaction = state_->redactor->counters();
  if (state_->sensory) counters.sensory = state_->sensory->counts();
  counters.memory = state_->memory->counters();
  if (state_->store) counters.store = state_->store->counters();
  if (state_->past != nullptr && state_->past->store() != nullptr)
    counters.reading = state_->past->store()->counters();
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

void MemoryService::tell_of_below(PastListener listener) {
  if (state_->options.below) state_->options.below->tell(std::move(listener));
}

Status MemoryService::close() {
  State& state = *state_;
  if (state.is_closed.exchange(true)) return {};
  if (state.options.below) state.options.below->detach();
  state.stop_forgetting();
  state.thread.request_stop();
  state.thread.join();
  if (state.sensory) state.sensory->close();
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
