// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "ltm/memory/commit.h"
#include "ltm/memory/query.h"
#include "ltm/memory/result.h"
#include "ltm/memory/segment_types.h"
#include "ltm/working/entity_history.h"
#include "ltm/working/memory_limits.h"

namespace engram::ltm {

/// What the online phase gets of working memory.
enum class StoreMode : uint8_t {
  kWhatLeaves,  ///< What leaves, before it does: the newest exists in RAM alone.
  kEverything,  ///< Everything, as it comes.
  kLatest,  ///< The newest of an entity at intervals; what leaves otherwise is gone, and counted.
};

/// What happened in a working memory since it was made. Unit: snapshots, unless named.
///
/// committed = superseded + left + dropped + those that are in it.
struct MemoryCounters {
  size_t entities = 0;   ///< That are in it.
  size_t snapshots = 0;  ///< That are in it, those that wait included.
  size_t bytes = 0;      ///< Of those that stay, as MemoryLimits counts them.
  size_t waiting = 0;    ///< For the online phase.
  size_t waiting_bytes = 0;
  uint64_t committed = 0;
  uint64_t superseded = 0;     ///< Another of the same entity and time came.
  uint64_t left = 0;           ///< Out of it; the online phase has them.
  uint64_t dropped = 0;        ///< Out of it, and not stored: StoreMode::kLatest.
  uint64_t stored = 0;         ///< Taken by the online phase.
  uint64_t refused = 0;        ///< Commits.
  uint64_t reinterpreted = 0;  ///< Instances that were cast to their segment's type at some cost.
  uint64_t reads = 0;          ///< Given out with their data.
};

/// What became of a commit.
struct Admission {
  std::vector<SharedSnapshot> snapshots;  ///< As they are in memory now, in the order of updates.
  /// What WorkingMemory::taken() reaches when the online phase has all that waits now.
  uint64_t queued = 0;
  /// What left memory for it: freed with this, and not while others wait for the memory.
  std::vector<SharedSnapshot> gone;
};

/// The snapshots of one entity that a query asks for.
struct SelectedEntity {
  MemoryId entity;
  std::vector<SharedSnapshot> snapshots;  ///< In the order of time.
  /// Which instances of each; empty: all.
  std::vector<std::vector<int32_t>> instances;
  /// Moments after the last snapshot that are asked for: to be predicted.
  std::vector<Time> future;
  /// What is asked for may lie elsewhere too, see select(): the rest of this says nothing.
  bool reaches_elsewhere = false;
};

/// Until when snapshots of an entity are known elsewhere; nothing where none is.
using KnownElsewhere = std::function<std::optional<Time>(const MemoryId& entity)>;

/// What a robot knows right now: plain data, nothing filtered or encoded, bounded, in RAM. What is
/// given out is shared, never copied.
///
/// Within a limit that is exceeded, the oldest snapshot of that entity leaves of which holding time
/// times size is largest for how often the entity, and what links to it, is read. Entities are
/// compared 16 at a time, drawn at random where there are more.
/// Threading: thread-safe.
/// Source: docs/working_memory.md.
class WorkingMemory {
 public:
  struct Options {
    MemoryLimits all{{}, size_t{512} << 20, {}};
    std::vector<SegmentLimits> segments;
    StoreMode mode = StoreMode::kWhatLeaves;
    Duration store_interval = std::chrono::seconds(1);  ///< Of StoreMode::kLatest.
    /// What may wait for the online phase beyond the limits. A commit beyond it is refused.
    size_t max_waiting_bytes = size_t{256} << 20;
    /// How long until a read counts half.
    Duration read_half_life = std::chrono::minutes(1);
    uint64_t seed = 1;  ///< Of the entities that are compared.

    [[nodiscard]] Status validate() const;
  };

  /// Takes snapshots for the long term, in the order in which they came.
  using Sink = std::function<Status(std::span<const SharedSnapshot>)>;

  /// Errors: kInvalidArgument.
  static Result<std::unique_ptr<WorkingMemory>> create(const Options& options,
                                                       Clock clock = system_now);
  ~WorkingMemory();

  /// Says what the values of a segment are: see SegmentTypes::declare. What is there already
  /// stays as it is.
  Status declare(const MemoryId& segment, const idf::Type& type);

  /// All of it or nothing. `arrived` of every instance becomes the time of now.
  /// Errors: those of Commit::check and SegmentTypes::reinterpret; kResourceExhausted
  /// where too much waits for the online phase.
  Status commit(Commit commit) { return admit(std::move(commit)).status(); }

  /// The same. With `encoded`, the data of each instance of each update as it came, in IDF's binary
  /// form, these bytes are kept beside the values for as long as they say the same. With `to_store`
  /// the online phase gets it whatever the mode.
  Result<Admission> admit(Commit commit, std::vector<std::vector<Buffer>> encoded = {},
                          bool to_store = false);

  /// How many of those that ever waited the online phase took.
  [[nodiscard]] uint64_t taken() const;

  /// The newest snapshot of an entity, or the one of exactly that time; null where there is none.
  [[nodiscard]] SharedSnapshot find(const MemoryId& id) const;

  /// What is asked for and is here. Entities that match and have no such snapshot are in it too.
  /// With `elsewhere`, entities are marked of which these alone do not tell what is asked for.
  [[nodiscard]] std::vector<SelectedEntity> select(const Query& query,
                                                   const KnownElsewhere& elsewhere = {}) const;

  /// The entities that a query asks for and that are here, in the order of their IDs.
  [[nodiscard]] std::vector<MemoryId> matching(const Query& query) const;

  /// The last `max` snapshots of an entity, in the order of time. Counts as no read.
  /// Complexity: O(most).
  [[nodiscard]] std::vector<SharedSnapshot> all_of(const MemoryId& entity,
                                                   size_t max = SIZE_MAX) const;

  /// So many snapshots of an entity that select() or all_of() gave were given out with their data:
  /// who answers knows whether they were, and once.
  void count_reads(const MemoryId& entity, size_t count) const;

  /// What was declared for the entity's segment.
  [[nodiscard]] std::optional<idf::Type> type_of(const MemoryId& entity) const;

  /// The same as an answer, without the moments that are to be predicted.
  [[nodiscard]] QueryResult query(const Query& query) const;

  /// Hands what waits to `sink`, at most `max_bytes` (one snapshot at least), and lets go of what
  /// was chosen to leave. Where the sink fails everything stays, and waits again.
  /// Returns how many were stored. Threading: one thread at a time; the others wait.
  /// Errors: those of the sink.
  Result<size_t> store(const Sink& sink, size_t max_bytes = SIZE_MAX);

  /// Chooses what is older than its limits. To be called now and then.
  void expire();

  /// Chooses everything, for the end.
  void release_all();

  /// Changes what may stay in all; what is too much is chosen to leave.
  /// Errors: kInvalidArgument.
  Status set_limits(const MemoryLimits& all);

  [[nodiscard]] MemoryCounters counters() const;

 private:
  struct State;
  explicit WorkingMemory(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace engram::ltm
