// SPDX-License-Identifier: Apache-2.0
#include "memory/live/memory_service_state.h"

#include <algorithm>
#include <unordered_set>

#include "ltm/core/log.h"
#include "ltm/recording/redaction_rules.h"

namespace engram::memory {

using ltm::MemoryId;

namespace {

/// The bound of what is handed over at once. Unit: bytes.
constexpr size_t kHandedOver = size_t{32} << 20;

}  // namespace

Status MemoryService::State::hand_over() {
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

Status MemoryService::State::record(std::span<const ltm::SharedSnapshot> snapshots) {
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

Status MemoryService::State::outcome(const ltm::Admission& admission) const {
  // Compares owners, not pointers: a refused snapshot may be freed, and its address used again.
  for (const auto* known : {&refused, &unstored})
    for (const RefusedSnapshot& one : *known)
      for (const ltm::SharedSnapshot& snapshot : admission.snapshots)
        if (!one.snapshot.owner_before(snapshot) && !snapshot.owner_before(one.snapshot))
          return one.status;
  return {};
}

void MemoryService::State::tell(const Status& status, uint64_t until) {
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

void MemoryService::State::tell_unstored(std::span<const ltm::SharedSnapshot> waited) {
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

ForgettingParts MemoryService::State::forgetting_parts() {
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
      .pass =
          [this](const ltm::Query& query, const ltm::View* view) {
            if (sensory) sensory->pass_chosen(query, view);
          },
      .unstored = [this](std::span<const ltm::SharedSnapshot> waited) { tell_unstored(waited); }};
}

void MemoryService::State::stop_forgetting() {
  stops_forgetting.request_stop();
  is_forgetting.wait(true);
}

void MemoryService::State::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    {
      const MutexLock lock(mutex);
      wake.wait_for(mutex, stop, options.store_interval,
                    [this]() ENGRAM_REQUIRES(mutex) { return !waiters.empty(); });
    }
    memory->expire();
    if (sensory) sensory->sweep(steady_now());
    // The status is told to waiters and logged by hand_over().
    const Status status = hand_over();
    if (!status.ok()) {
      const MutexLock lock(mutex);
      wake.wait_for(mutex, stop, options.store_interval, [] { return false; });
    }
  }
}

Status MemoryService::State::open_past(ltm::ModelLoader loader) {
  std::unique_ptr<ltm::StorePast> stored;
  std::unique_ptr<ltm::AccessLog> accesses;
  ltm::RecordedEntities* recorded = &nothing_recorded;
  if (options.store) {
    ENGRAM_ASSIGN_OR_RETURN(redactor, ltm::make_redactor(options.store->recording.rules));
    ENGRAM_ASSIGN_OR_RETURN(store, LongTerm::open(*options.store, clock, redactor));
    const std::filesystem::path& path = options.store->store;
    likeness.emplace(path, loader, memory.get());
    ENGRAM_ASSIGN_OR_RETURN(
        stored, ltm::StorePast::open(path, std::move(loader), {options.store->max_decoded_bytes}));
    accesses = std::make_unique<ltm::AccessLog>(path, ltm::AccessLog::Options{});
    recorded = &store->recorded();
    const ltm::SegmentTypes types = store->types();
    for (const auto& [segment, type] : types.all())
      ENGRAM_RETURN_IF_ERROR(memory->declare(segment, type));
    recalling_options.prefer =
        options.store->prefers_latents ? ltm::Prefer::kLatent : ltm::Prefer::kRecorded;
    recalling_options.max_answer_bytes = options.store->max_answer_bytes;
  }
  room.emplace(options.name, options.max_entities, *memory, *recorded);
  recalling_options.max_horizon = options.max_horizon;
  if (options.below) {
    ENGRAM_ASSIGN_OR_RETURN(redactor, ltm::make_redactor(options.redacting));
    recalling_options.max_answer_bytes = options.max_answer_bytes;
    const ltm::SegmentTypes types = options.below->types();
    for (const auto& [segment, type] : types.all())
      ENGRAM_RETURN_IF_ERROR(memory->declare(segment, type));
    auto below = options.below->attach("server '" + options.name + "'", *memory);
    const MutexLock lock(recalling);
    recall.emplace(std::move(below));
    return {};
  }
  auto joined = ltm::JoinedPast::create("server '" + options.name + "'", *memory, std::move(stored),
                                        *recorded);
  past = joined.get();
  const MutexLock lock(recalling);
  recall.emplace(std::move(joined), std::move(accesses));
  return {};
}

}  // namespace engram::memory
