// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>

#include "ltm/core/mutex.h"
#include "memory/live/sensory_source.h"

namespace engram::memory {

/// The snapshots of one sensory segment that this process holds itself, for providers that share no
/// memory with it.
///
/// Threading: thread-safe.
class PlainRing final : public SensorySource {
 public:
  PlainRing(SensorySegment segment, size_t max_bytes, PassCommit pass)
      : segment_(std::move(segment)), max_bytes_(max_bytes), pass_(std::move(pass)) {}

  /// Holds a snapshot unless its entity is attended to: then what came before has passed when this
  /// returns false, and the snapshot is for working memory. Moves from what it holds.
  bool hold(const SharedSensoryEntity& entity, ltm::EntityUpdate& update,
            std::vector<Buffer>& encoded);

  /// What a snapshot takes here.
  static size_t bytes_of(const ltm::EntityUpdate& update, const std::vector<Buffer>& encoded);

  void pass() override;
  void pass_chosen(const IsChosen& is_chosen) override;
  void note_earliest(EarliestTimes& times) const override;
  bool sweep(SteadyTime now) override;
  [[nodiscard]] SensoryCounts counts() const override;

 private:
  struct HeldUpdate {
    SharedSensoryEntity entity;
    SteadyTime came;
    size_t bytes = 0;
    ltm::EntityUpdate update;
    std::vector<Buffer> encoded;
  };
  using Held = std::deque<HeldUpdate>;

  void pass_attended(SteadyTime now) ENGRAM_REQUIRES(mutex_);
  void pass_one(HeldUpdate& one) ENGRAM_REQUIRES(mutex_);
  /// Moves the oldest to `gone`, which is freed without the lock.
  void drop_oldest(Held& gone) ENGRAM_REQUIRES(mutex_);
  void drop_old(SteadyTime now, Held& gone) ENGRAM_REQUIRES(mutex_);

  const SensorySegment segment_;
  const size_t max_bytes_;
  const PassCommit pass_;
  /// Held while snapshots pass, so that nobody overtakes them.
  mutable Mutex mutex_;
  Held held_ ENGRAM_GUARDED_BY(mutex_);
  size_t bytes_ ENGRAM_GUARDED_BY(mutex_) = 0;
  SensoryCounts counts_ ENGRAM_GUARDED_BY(mutex_);
};

}  // namespace engram::memory
