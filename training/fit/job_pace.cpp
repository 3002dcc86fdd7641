// SPDX-License-Identifier: Apache-2.0
#include "training/fit/job_pace.h"

#include <thread>

#include "ltm/core/local_time.h"

namespace engram::training {

namespace {

constexpr auto kSleep = std::chrono::milliseconds(100);
/// Each step ends in time by itself. This is for one that took much longer than expected.
constexpr Duration kGrace = std::chrono::seconds(15);

}  // namespace

JobPace::JobPace(Busy* busy, const ProgressSink& progress, const std::stop_token& stop,
                 std::optional<Time> end, Clock clock)
    : busy_(busy),
      progress_(progress),
      stop_(stop),
      end_(end),
      clock_(std::move(clock)),
      sink_([this](const Progress& now) {
        last_ = now;
        if (progress_) progress_(now);
      }) {}

bool JobPace::is_busy() {
  return busy_ != nullptr && busy_->reason().has_value();
}

Status JobPace::pause() {
  if (stop_.stop_requested()) return cancelled("the job was stopped");
  if (end_ && clock_() >= *end_ + kGrace) {
    is_time_over_ = true;
    return resource_exhausted("the time was over at {}", to_local_string(*end_));
  }
  if (busy_ == nullptr) return {};
  const auto start = std::chrono::steady_clock::now();
  for (auto reason = busy_->reason(); reason; reason = busy_->reason()) {
    Progress waiting = last_;
    waiting.detail = "waiting: " + *reason;
    waiting.seconds_left = -1;
    if (progress_) progress_(waiting);
    if (end_ && clock_() >= *end_) {
      is_time_over_ = true;
      return resource_exhausted("the robot was busy until the time was over ({})",
                                to_local_string(*end_));
    }
    std::this_thread::sleep_for(kSleep);
    if (stop_.stop_requested()) return cancelled("the job was stopped while it waited");
  }
  paused_seconds_ += to_seconds(std::chrono::steady_clock::now() - start);
  return {};
}

}  // namespace engram::training
