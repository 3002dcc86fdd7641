// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "ltm/core/mutex.h"
#include "ltm/core/time.h"
#include "memory/replay/replay_options.h"

namespace engram::memory {

/// The clock of a replay: it goes at a speed, stands still, and can be set.
///
/// Threading: thread-safe.
/// Source: docs/replay.md.
class ReplayClock {
 public:
  /// Stands still at `at`. Needs a speed that check_replay_speed() takes (checked).
  ReplayClock(Time at, double speed, SteadyClock steady = steady_now);

  /// The replayed moment. It never passes the end of a loop by itself.
  [[nodiscard]] Time now() const;

  /// What it does.
  struct Course {
    Time now{};
    double speed = 1;
    bool is_playing = false;
    std::optional<ReplayLoop> loop;
    uint64_t jumps = 0;  ///< How often it was set to another moment.
  };
  [[nodiscard]] Course course() const;

  void set_playing(bool is_playing);
  void set_speed(double speed);
  /// Sets it, and counts a jump.
  void jump(Time to);
  /// Sets it to a moment that it would have reached by itself.
  void advance(Time to);
  void set_loop(std::optional<ReplayLoop> loop);

  /// How long until it shows `time`: zero if it does, the maximum if it never will.
  [[nodiscard]] Duration until(Time time) const;

 private:
  [[nodiscard]] Time read() const ENGRAM_REQUIRES(mutex_);
  void set(Time now) ENGRAM_REQUIRES(mutex_);

  const SteadyClock steady_;
  mutable Mutex mutex_;
  Time anchor_ ENGRAM_GUARDED_BY(mutex_);  ///< What it showed at `anchored_at_`.
  SteadyTime anchored_at_ ENGRAM_GUARDED_BY(mutex_);
  double speed_ ENGRAM_GUARDED_BY(mutex_);
  bool is_playing_ ENGRAM_GUARDED_BY(mutex_) = false;
  std::optional<ReplayLoop> loop_ ENGRAM_GUARDED_BY(mutex_);
  uint64_t jumps_ ENGRAM_GUARDED_BY(mutex_) = 0;
};

}  // namespace engram::memory
