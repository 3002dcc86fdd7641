// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <thread>
#include <vector>

#include "ltm/core/mutex.h"
#include "memory/memory.h"
#include "server/navigation/floor_things.h"
#include "server/navigation/obstacle_map.h"

namespace engram::navigation {

/// Keeps a cost map in a memory up to date with the objects and furniture in that memory.
///
/// It subscribes to them and commits a map, a navigation::CostMap, whenever one of them moved. What
/// comes while a map is made goes into the next one. The time of a map is that of the newest
/// snapshot in it, or a nanosecond more than that of the map before. As long as no thing is known
/// none is committed, because nothing tells the time.
/// Threading: thread-safe; a thread of its own makes the maps.
/// Owns: nothing of the memory, which must outlive it.
/// Source: docs/navigation.md.
class CostMapProvider {
 public:
  struct Options {
    MapRules rules;
    /// Walls and rooms that nothing moves, in the frame of the rules; empty: an empty floor.
    std::optional<cv::Mat> base{};
    /// How long a commit that failed, or a question about what was lost, waits until it is tried
    /// again.
    Duration retry = std::chrono::seconds(1);
  };

  struct Counters {
    uint64_t snapshots = 0;  ///< Told of things and classes.
    uint64_t lost = 0;       ///< Told too late; what is known was asked for anew.
    uint64_t maps = 0;
    uint64_t failed_commits = 0;
    std::string last_failure;
  };

  /// Returns once the first map is committed, if anything is known.
  /// Errors: kInvalidArgument for options that do not validate; those of Memory::subscribe, query,
  /// declare and commit.
  static Result<std::unique_ptr<CostMapProvider>> start(Memory& memory, const Options& options);

  ~CostMapProvider();

  /// The last map that was committed; an empty floor without a time where none was.
  [[nodiscard]] CostMap latest() const;

  /// Waits until a snapshot of a thing or class, or a newer one of it, is in the last committed map
  /// or is known not to change it, however the provider came to know it: it was there at the start,
  /// was told, or was asked for after something was lost. A snapshot that no rule names never is.
  /// Returns false after `timeout`.
  [[nodiscard]] bool wait_for(const ltm::MemoryId& snapshot, Duration timeout) const;

  [[nodiscard]] Counters counters() const;

 private:
  CostMapProvider(Memory& memory, const Options& options, FloorThings things, ObstacleMap map);

  Status begin();
  /// Asks what is known of all that counts.
  Status ask();
  void run(const std::stop_token& stop);
  Status bring_up_to_date();
  Status commit_map();
  void note_done();

  Memory& memory_;
  const Options options_;
  const ltm::MemoryId entity_;
  // These belong to the thread, and before it starts to start().
  FloorThings things_;
  ObstacleMap map_;
  Time last_time_{};
  int64_t version_ = 0;
  /// What things_ took since the last map that was committed.
  std::map<ltm::MemoryId, Time> taken_;
  bool is_outdated_ = true;  ///< The map that is committed is not the one that is here.

  mutable Mutex mutex_;
  StoppableCondition has_work_;
  mutable ConditionVariable is_done_;
  std::vector<ltm::Snapshot> waiting_ ENGRAM_GUARDED_BY(mutex_);
  bool must_ask_ ENGRAM_GUARDED_BY(mutex_) = false;
  CostMap latest_ ENGRAM_GUARDED_BY(mutex_);
  std::map<ltm::MemoryId, Time> done_ ENGRAM_GUARDED_BY(mutex_);
  Counters counters_ ENGRAM_GUARDED_BY(mutex_);

  std::unique_ptr<Subscription> subscription_;
  std::jthread thread_;
};

}  // namespace engram::navigation
