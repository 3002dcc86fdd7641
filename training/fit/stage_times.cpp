// SPDX-License-Identifier: Apache-2.0
#include "training/fit/stage_times.h"

#include <chrono>
#include <ctime>
#include <utility>

#include "ltm/core/time.h"

namespace engram::training {

std::string_view to_string(Stage stage) {
  constexpr std::array<std::string_view, kStages> kNames{
      "plan",      "samples", "reading",      "training",   "latents",
      "residuals", "video",   "verification", "publishing", "other"};
  return kNames[static_cast<size_t>(stage)];
}

StageTime process_clocks() {
  // In POSIX systems std::clock() counts the threads that have ended, too.
  return {static_cast<double>(std::clock()) / CLOCKS_PER_SEC,
          to_seconds(std::chrono::steady_clock::now().time_since_epoch())};
}

StageTimes::StageTimes(Clocks clocks) : clocks_(std::move(clocks)) {}

StageTime StageTimes::total() const {
  StageTime sum;
  for (const StageTime& one : spent_) {
    sum.processor_seconds += one.processor_seconds;
    sum.seconds += one.seconds;
  }
  return sum;
}

std::optional<Stage> StageTimes::change_to(std::optional<Stage> stage) {
  const StageTime now = clocks_();
  if (stage_) {
    StageTime& spent = spent_[static_cast<size_t>(*stage_)];
    spent.processor_seconds += now.processor_seconds - changed_at_.processor_seconds;
    spent.seconds += now.seconds - changed_at_.seconds;
  }
  changed_at_ = now;
  return std::exchange(stage_, stage);
}

StageTimes::Scope::Scope(StageTimes* times, Stage stage) : times_(times) {
  if (times_ != nullptr) interrupted_ = times_->change_to(stage);
}

StageTimes::Scope::~Scope() {
  if (times_ != nullptr) times_->change_to(interrupted_);
}

}  // namespace engram::training
