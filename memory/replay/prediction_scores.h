// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "ltm/core/mutex.h"
#include "ltm/memory/commit.h"
#include "ltm/recall/answer.h"
#include "ltm/recall/known_past.h"

namespace engram::memory {

/// One instance of a prediction that was compared with what came.
struct PredictionScore {
  ltm::MemoryId entity;
  int32_t instance = 0;
  Time time{};         ///< The predicted moment.
  Time came{};         ///< The time of the snapshot that it was compared with.
  Duration horizon{};  ///< How far ahead it was.
  std::string engine;
  std::string model;
  ltm::MeasuredError error;     ///< What it was.
  ltm::MeasuredError expected;  ///< What was told.
  ltm::MeasuredError bound;

  [[nodiscard]] bool has_bound() const;
  /// Whether each error that has a bound keeps it.
  [[nodiscard]] bool is_within_bound() const;
  [[nodiscard]] idf::Data to_data() const;
};

/// The commit that tells scores at `now`: an update for each entity, with an instance for each
/// score.
[[nodiscard]] ltm::Commit commit_of(const std::vector<PredictionScore>& scores, Time now);

/// Keeps predictions until what they are of has come, and compares them then.
///
/// A prediction is compared with the snapshot that is nearest to its moment, once one at or after
/// that moment has arrived. If the nearest is more than half of the horizon away, or none has come
/// a minute after the moment, it is not compared, and counted.
/// Threading: thread-safe; the past is used by who calls compare().
/// Source: docs/replay.md, "Predictions are scored".
class PredictionScores {
 public:
  /// Max predictions that wait, and what they take, images decoded; beyond it the oldest are given
  /// up.
  static constexpr size_t kMaxWaiting = 1024;
  static constexpr size_t kMaxWaitingBytes = size_t{64} << 20;
  static constexpr Duration kMaxWait = std::chrono::minutes(1);

  /// Takes the predictions of an answer that was given out.
  void add(const ltm::Answer& answer);

  /// Drops predictions that start from snapshots after `now`: nobody has asked them yet.
  void rewind(Time now);

  /// Compares those whose moment is at or before `now`. `past` shows what had come by then, and is
  /// renewed if its store has changed so that it cannot be read.
  std::vector<PredictionScore> compare(Time now, ltm::KnownPast& past);

  [[nodiscard]] bool has_waiting() const;

  /// Predictions that were not compared with anything. Unit: instances.
  [[nodiscard]] uint64_t unscored() const;

 private:
  struct Waiting {
    ltm::MemoryId entity;
    ltm::SnapshotResult predicted;
    size_t bytes = 0;
  };
  enum class Outcome { kWaits, kOutdated, kCompared, kGivenUp };

  static Outcome compare_one(const Waiting& one, ltm::KnownPast& past,
                             std::vector<PredictionScore>& scores);
  void keep_bounds() ENGRAM_REQUIRES(mutex_);
  std::deque<Waiting> take_if(const std::function<bool(const ltm::SnapshotResult&)>& is_taken)
      ENGRAM_REQUIRES(mutex_);

  mutable Mutex mutex_;
  std::deque<Waiting> waiting_ ENGRAM_GUARDED_BY(mutex_);
  size_t waiting_bytes_ ENGRAM_GUARDED_BY(mutex_) = 0;
  uint64_t unscored_ ENGRAM_GUARDED_BY(mutex_) = 0;
};

}  // namespace engram::memory
