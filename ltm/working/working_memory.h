// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "ltm/core/time_set.h"
#include "ltm/memory/ahead_limits.h"
#include "ltm/memory/commit.h"
#include "ltm/memory/query.h"
#include "ltm/memory/result.h"
#include "ltm/memory/segment_types.h"
#include "ltm/working/entity_history.h"
#include "ltm/working/memory_limits.h"

namespace engram::ltm {

/// What working memory hands to the online phase.
enum class StoreMode : uint8_t {
  /// Snapshots that leave, before they leave. The newest ones exist in RAM only.
  kWhatLeaves,
  kEverything,  ///< Every snapshot, as it comes.
  /// The newest snapshot of each entity at intervals. Other snapshots that leave are dropped and
  /// counted.
  kLatest,
};

/// What happened in a working memory since it was created. Unit: snapshots, unless named.
///
/// committed = superseded + left + dropped + forgotten + the snapshots in it.
struct MemoryCounters {
  size_t entities = 0;   ///< Entities in it now.
  size_t snapshots = 0;  ///< In it now, including those that wait.
  size_t bytes = 0;      ///< The size of those that stay, as MemoryLimits counts it.
  size_t waiting = 0;    ///< They wait for the online phase now.
  size_t waiting_bytes = 0;
  uint64_t committed = 0;
  uint64_t superseded = 0;     ///< Replaced by another of the same entity and time.
  uint64_t left = 0;           ///< They left it, and the online phase has them.
  uint64_t dropped = 0;        ///< They left it and were not stored: StoreMode::kLatest.
  uint64_t forgotten = 0;      ///< Taken out of it by forget().
  uint64_t stored = 0;         ///< Taken by the online phase.
  uint64_t refused = 0;        ///< Refused commits.
  uint64_t reinterpreted = 0;  ///< Instances that lost something in the cast to their type.
  uint64_t reads = 0;          ///< Snapshots that were answered with their data.
};

/// What a commit returns.
struct Admission {
  /// The committed snapshots as they are in memory, in the order of updates.
  std::vector<SharedSnapshot> snapshots;
  /// The value that WorkingMemory::taken() reaches once the online phase has everything that waits
  /// now.
  uint64_t queued = 0;
  /// The snapshots that left memory. They are freed with this object, and not under the memory's
  /// lock.
  std::vector<SharedSnapshot> gone;
};

/// The snapshots of one entity that a query selects.
struct SelectedEntity {
  MemoryId entity;
  std::vector<SharedSnapshot> snapshots;  ///< In the order of time.
  /// The selected instances of each snapshot; empty: all.
  std::vector<std::vector<int32_t>> instances;
  /// Selected moments after the last snapshot, to be predicted.
  std::vector<Time> future;
  /// The selected snapshots may also lie elsewhere, see select(); the other members are then
  /// invalid.
  bool reaches_elsewhere = false;
};

/// The time of the last snapshot of an entity that is known elsewhere; nothing where there is none.
using KnownElsewhere = std::function<std::optional<Time>(const MemoryId& entity)>;

/// What a robot knows right now: plain data in RAM, bounded, neither filtered nor encoded. Answers
/// share the snapshots and do not copy them.
///
/// When a limit is exceeded, the oldest snapshot of one entity leaves: the one with the largest
/// holding time times size per read of the entity and of what links to it. At most 16 entities are
/// compared; if there are more, 16 are drawn at random.
/// Threading: thread-safe.
/// Source: docs/working_memory.md.
class WorkingMemory {
 public:
  struct Options {
    MemoryLimits all{{}, size_t{512} << 20, {}};
    std::vector<SegmentLimits> segments;
    AheadLimits ahead;
    StoreMode mode = StoreMode::kWhatLeaves;
    Duration store_interval = std::chrono::seconds(1);  ///< For StoreMode::kLatest.
    /// The bound of bytes that wait for the online phase in excess of the limits. Beyond it commits
    /// are refused.
    size_t max_waiting_bytes = size_t{256} << 20;
    /// The time after which a read counts half.
    Duration read_half_life = std::chrono::minutes(1);
    uint64_t seed = 1;  ///< Seeds the draw of the compared entities.

    [[nodiscard]] Status validate() const;
  };

  /// Changes a commit whose values have been cast to their segments' types, before memory has it:
  /// it may change values within their types, and take out updates with their bytes. `encoded` is
  /// empty or as long as the updates, before and after.
  using Change = std::function<void(Commit& commit, std::vector<std::vector<Buffer>>& encoded)>;

  /// Takes snapshots for the long term, in the order in which they came.
  using Sink = std::function<Status(std::span<const SharedSnapshot>)>;

  /// Errors: kInvalidArgument.
  static Result<std::unique_ptr<WorkingMemory>> create(const Options& options,
                                                       Clock clock = system_now);
  ~WorkingMemory();

  /// Sets the type of a segment's values, see SegmentTypes::declare. Snapshots that are already
  /// here stay as they are.
  Status declare(const MemoryId& segment, const idf::Type& type);

  /// Commits all updates or none. `arrived` of every instance becomes the current time.
  /// Errors: those of Commit::check and SegmentTypes::reinterpret; kInvalidArgument where a time
  /// lies too far ahead of the clock; kResourceExhausted where too many bytes wait for the online
  /// phase.
  Status commit(Commit commit) { return admit(std::move(commit)).status(); }

  /// Commits all updates or none, see commit(). `encoded` holds the data of each instance of each
  /// update as it came, in IDF's binary form; these bytes are kept beside the values, unless a cast
  /// changes the values. With `to_store` the online phase gets the commit in every mode.
  ///
  /// `change` is called once for what would be admitted, without a lock, so that it may take long.
  /// A type that is declared meanwhile holds for later commits. If it takes out everything, nothing
  /// is admitted.
  Result<Admission> admit(Commit commit, std::vector<std::vector<Buffer>> encoded = {},
                          bool to_store = false, const Change& change = {});

  /// The number of snapshots that the online phase took or that were forgotten before, of all that
  /// ever waited, up to the first one that waits now.
  [[nodiscard]] uint64_t taken() const;

  /// The newest snapshot of an entity, or the one of exactly this time; null where there is none.
  [[nodiscard]] SharedSnapshot find(const MemoryId& id) const;

  /// Whether it has snapshots of an entity, and the number of such entities.
  [[nodiscard]] bool has(const MemoryId& entity) const;
  [[nodiscard]] size_t entity_count() const;

  /// The selected snapshots that are here. It also holds entities that match but have no selected
  /// snapshot. With `elsewhere`, entities are marked whose snapshots here are not enough to answer
  /// the query.
  [[nodiscard]] std::vector<SelectedEntity> select(const Query& query,
                                                   const KnownElsewhere& elsewhere = {}) const;

  /// The entities that match a query and are here, in the order of their IDs.
  [[nodiscard]] std::vector<MemoryId> matching(const Query& query) const;

  /// The last `max` snapshots of an entity, in the order of time. Does not count as a read.
  /// Complexity: O(max).
  [[nodiscard]] std::vector<SharedSnapshot> all_of(const MemoryId& entity,
                                                   size_t max = SIZE_MAX) const;

  /// Counts this many snapshots of select() or all_of() as read. The caller does this once, for the
  /// snapshots that it answered with their data.
  void count_reads(const MemoryId& entity, size_t count) const;

  /// The type of the entity's segment; nothing where none was declared.
  [[nodiscard]] std::optional<idf::Type> type_of(const MemoryId& entity) const;

  /// Answers a query without the moments that are to be predicted.
  [[nodiscard]] QueryResult query(const Query& query) const;

  /// Hands waiting snapshots to `sink`, at most `max_bytes` (but at least one snapshot), and frees
  /// those that were chosen to leave. Where the sink fails everything stays and waits again.
  /// Returns how many were stored.
  /// Threading: one thread at a time; the others wait.
  /// Errors: those of the sink.
  Result<size_t> store(const Sink& sink, size_t max_bytes = SIZE_MAX);

  /// Removes the snapshots of these times, and those of the same times that wait for the online
  /// phase: it never gets them. Before anything else can be stored, `unstored` is called with those
  /// that waited, if there are any. Waits for a sink that runs. Returns how many snapshots left.
  size_t forget(const std::map<MemoryId, TimeSet>& gone,
                const std::function<void(std::span<const SharedSnapshot>)>& unstored = {});

  /// Chooses snapshots older than their limits to leave. Call it regularly.
  void expire();

  /// Chooses everything to leave, before the end.
  void release_all();

  /// Changes the limits of the whole memory; what exceeds them is chosen to leave.
  /// Errors: kInvalidArgument.
  Status set_limits(const MemoryLimits& all);

  [[nodiscard]] MemoryCounters counters() const;

 private:
  struct State;
  explicit WorkingMemory(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace engram::ltm
