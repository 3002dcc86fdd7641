// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the state of a memory service, and what its thread does with it.

#include <atomic>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "ltm/core/mutex.h"
#include "ltm/likeness/store_likeness.h"
#include "ltm/recall/joined_past.h"
#include "ltm/recall/recall.h"
#include "memory/live/entity_room.h"
#include "memory/live/live_forgetting.h"
#include "memory/live/long_term.h"
#include "memory/live/memory_service.h"

namespace engram::memory {

/// The bound of refused snapshots that are remembered for those who wait for them.
inline constexpr size_t kMaxRefused = 4096;

/// Somebody who waits until a commit is stored.
struct Waiter {
  uint64_t number = 0;
  ltm::Admission admission;
  std::function<void(const Status&)> done;
};

/// A snapshot that will never be stored, and why.
struct RefusedSnapshot {
  std::weak_ptr<const ltm::HeldSnapshot> snapshot;
  Status status;
};

struct MemoryService::State {
  State(const Options& given, Clock now) : options(given), clock(std::move(now)) {}

  const Options options;
  const Clock clock;
  std::unique_ptr<ltm::WorkingMemory> memory;
  std::shared_ptr<ltm::Redactor> redactor;  ///< Null if nothing is redacted.
  std::unique_ptr<LongTerm> store;          ///< Null without a store.
  Mutex recalling;                          ///< Held while `recall` answers: one query at a time.
  std::optional<ltm::Recall> recall ENGRAM_GUARDED_BY(recalling);
  /// The past that `recall` answers from; null if it is Options::below.
  const ltm::JoinedPast* past = nullptr;
  ltm::Recall::Options recalling_options;
  ltm::RecordedEntities nothing_recorded;  ///< Stands in for LongTerm::recorded() without a store.

  std::shared_ptr<SensoryMemory> sensory;      ///< Null where nothing is sensory.
  TellPassed tell_passed;                      ///< Set before anything is committed.
  std::optional<EntityRoom> room;              ///< Made with the past.
  std::optional<ltm::StoreLikeness> likeness;  ///< Made with the past; nothing without a store.

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
  Status hand_over() ENGRAM_EXCLUDES(mutex);

  Status record(std::span<const ltm::SharedSnapshot> snapshots) ENGRAM_EXCLUDES(mutex);

  /// The status of a commit that the online phase took.
  [[nodiscard]] Status outcome(const ltm::Admission& admission) const ENGRAM_REQUIRES(mutex);

  void tell(const Status& status, uint64_t until) ENGRAM_EXCLUDES(mutex);

  /// Tells those who wait for snapshots that were forgotten before they were stored.
  void tell_unstored(std::span<const ltm::SharedSnapshot> waited) ENGRAM_EXCLUDES(mutex);

  [[nodiscard]] ForgettingParts forgetting_parts();

  /// Waits until nobody forgets any more.
  void stop_forgetting();

  void run(const std::stop_token& stop);

  /// Opens the store and what answers from it and from working memory.
  Status open_past(ltm::ModelLoader loader);

  /// Counts the snapshots that were answered from working memory as read: this decides which may
  /// leave.
  void count_answer(const ltm::Answer& answer);

  [[nodiscard]] ltm::KnownElsewhere elsewhere() const;

  /// Opens the attention of a query to sensory entities.
  void attend(const ltm::Query& query, const ltm::View* view) {
    if (sensory) sensory->attend(query, view);
  }
};

}  // namespace engram::memory
