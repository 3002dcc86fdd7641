// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <stop_token>

#include "ltm/core/progress.h"
#include "ltm/core/time.h"
#include "training/fit/busy.h"

namespace engram::training {

/// Where a long job pauses, stops and tells how far it is.
///
/// Threading: one thread.
class JobPace {
 public:
  /// `busy` may be null, `progress` empty. `end`: the job waits no longer than until then. All
  /// outlive it.
  JobPace(Busy* busy, const ProgressSink& progress, const std::stop_token& stop,
          std::optional<Time> end = {}, Clock clock = system_now);
  JobPace(const JobPace&) = delete;
  JobPace& operator=(const JobPace&) = delete;

  /// Hands on what it is told, and tells it again while the robot is busy. Never empty.
  [[nodiscard]] const ProgressSink& progress() const { return sink_; }
  [[nodiscard]] const std::stop_token& stop() const { return stop_; }

  /// Whether pause() would wait.
  [[nodiscard]] bool is_busy();

  /// Sleeps as long as the robot is busy.
  /// Errors: kCancelled on a stop; kResourceExhausted where the robot is busy until the end.
  Status pause();

  /// That pause() slept, all in all.
  [[nodiscard]] double paused_seconds() const { return paused_seconds_; }
  /// Whether pause() gave up since the end had come.
  [[nodiscard]] bool is_time_over() const { return is_time_over_; }

 private:
  Busy* busy_;
  const ProgressSink& progress_;
  const std::stop_token& stop_;
  std::optional<Time> end_;
  Clock clock_;
  ProgressSink sink_;
  Progress last_;
  double paused_seconds_ = 0;
  bool is_time_over_ = false;
};

}  // namespace engram::training
