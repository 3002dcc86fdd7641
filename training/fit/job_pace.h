// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <stop_token>

#include "ltm/core/progress.h"
#include "ltm/core/time.h"
#include "training/fit/busy.h"

namespace engram::training {

/// Lets a long job pause, stop and report its progress.
///
/// Threading: one thread.
class JobPace {
 public:
  /// `busy` may be null and `progress` empty. The job waits until `end` at the latest, and is over
  /// some seconds later whatever it does. All arguments must outlive this object.
  JobPace(Busy* busy, const ProgressSink& progress, const std::stop_token& stop,
          std::optional<Time> end = {}, Clock clock = system_now);
  JobPace(const JobPace&) = delete;
  JobPace& operator=(const JobPace&) = delete;

  /// Passes progress on, and repeats it while the robot is busy. It is never empty.
  [[nodiscard]] const ProgressSink& progress() const { return sink_; }
  [[nodiscard]] const std::stop_token& stop() const { return stop_; }

  [[nodiscard]] Time now() const { return clock_(); }

  /// Whether pause() would wait.
  [[nodiscard]] bool is_busy();

  /// Sleeps while the robot is busy.
  /// Errors: kCancelled on a stop; kResourceExhausted if the robot is busy until the end, or the end
  /// was 15 s ago.
  Status pause();

  /// Total time that pause() slept.
  [[nodiscard]] double paused_seconds() const { return paused_seconds_; }
  /// Whether pause() gave up because the end was reached.
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
