// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "memory/live/past_below.h"
#include "memory/replay/arrival_order.h"
#include "memory/replay/prediction_scores.h"

namespace engram::memory {

/// One store of a replay: the order in which its snapshots came, the memory that is served above
/// it, and who is told.
///
/// Threading: pass(), prepare(), next(), restart() and score() by one thread at a time; the others
/// by any.
class ReplayPart {
 public:
  /// `now` is the replayed moment, in any thread.
  /// Errors: those of ltm::StorePast::open.
  static Result<std::unique_ptr<ReplayPart>> open(const std::filesystem::path& store,
                                                  ltm::ModelLoader loader, Clock now);

  [[nodiscard]] const std::filesystem::path& store() const { return store_; }
  [[nodiscard]] ltm::SegmentTypes types() const { return types_; }
  /// Times of the first and the last snapshot; nothing if there is none.
  [[nodiscard]] std::optional<Time> first() const { return first_; }
  [[nodiscard]] std::optional<Time> last() const { return last_; }

  /// See PastBelow.
  std::unique_ptr<ltm::KnownPast> attach(const std::string& name, ltm::WorkingMemory& above);
  void detach();
  void tell(PastListener listener);
  PredictionScores& predictions() { return predictions_; }

  /// Lets the memory above forget what was committed after `now`, and predictions from later.
  void rewind(Time now);
  /// Lets it forget these snapshots.
  void take_back(std::span<const ltm::SharedSnapshot> snapshots);
  /// The same of those that were committed after the replayed moment.
  void take_back_later(std::span<const ltm::SharedSnapshot> snapshots);

  /// Goes on behind what had arrived at `now`.
  void restart(Time now);
  /// See ArrivalOrder. False also if the store had to be renewed, so that it begins anew.
  /// Errors: those of ltm::StoreReader::open, if the store cannot be renewed.
  Result<bool> prepare(size_t max);
  [[nodiscard]] std::optional<Time> next() const { return order_.next(); }

  struct Passed {
    uint64_t snapshots = 0;
    uint64_t unreadable = 0;
  };
  /// Tells who wants to know of the next arrival. Needs one (checked).
  Passed pass();

  /// Compares predictions with what had come at `now`.
  /// Errors: those of ltm::StorePast::open; the predictions wait on.
  Result<std::vector<PredictionScore>> score(Time now);

  /// Commits to the memory above, and tells who wants to know.
  void commit(ltm::Commit commit);

 private:
  ReplayPart(std::filesystem::path store, ltm::ModelLoader loader, Clock now,
             std::unique_ptr<ltm::ReplayedPast> all);

  Status renew();
  /// Errors: kNotFound if it is not in the store any more.
  Result<ltm::SnapshotResult> read(const ltm::MemoryId& id);
  std::vector<ltm::SharedSnapshot> read_wanted(const std::vector<ltm::MemoryId>& ids,
                                               uint64_t& unreadable) ENGRAM_REQUIRES_SHARED(mutex_);

  const std::filesystem::path store_;
  const ltm::ModelLoader loader_;
  const Clock now_;
  ltm::SegmentTypes types_;
  std::optional<Time> first_, last_;

  const std::unique_ptr<ltm::ReplayedPast> all_;  ///< Shows everything.
  ArrivalOrder order_;
  Time restarted_{};  ///< Where the order goes on if the store has to be renewed.
  std::unique_ptr<ltm::ReplayedPast> come_;  ///< Shows what had come; made when it is needed.
  PredictionScores predictions_;

  mutable SharedMutex mutex_;
  ltm::WorkingMemory* above_ ENGRAM_GUARDED_BY(mutex_) = nullptr;
  PastListener listener_ ENGRAM_GUARDED_BY(mutex_);
  std::unique_ptr<ltm::ReplayedPast> to_attach_ ENGRAM_GUARDED_BY(mutex_);
};

}  // namespace engram::memory
