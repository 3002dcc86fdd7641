// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: when time may pass in a stepped body, as far as its skills are concerned.

#include <cstdint>
#include <map>
#include <optional>

#include "datasets/kitchen/body_steps.h"

namespace engram::datasets::kitchen {

/// Counts the executions of skills and their buses, and says whether they are done with a sample.
///
/// Each execution has one bus. From its begin until its bus waits for the first time, and whenever
/// its bus does not wait, time stands still. Without executions it passes, unless it is held.
/// Threading: one thread.
class SkillSteps {
 public:
  explicit SkillSteps(bool is_held) : is_held_(is_held) {}

  /// Errors: kFailedPrecondition if an execution ends that did not begin.
  Status take(SkillStep step);

  /// The bus of an execution is done with all before `until`.
  void wait(uint64_t bus, uint64_t until) { buses_[bus] = until; }
  /// The bus is there no longer.
  void leave(uint64_t bus) { buses_.erase(bus); }

  /// Lets time pass while it is held. What has its ID already goes on.
  /// Errors: kFailedPrecondition if time is not held, or if it passes for somebody else.
  Status pass(const PassWish& wish, uint64_t sample);
  [[nodiscard]] bool has_passed(uint64_t id) const { return pass_ && pass_->id == id && is_over_; }

  /// A sample came.
  void note(uint64_t sample) { is_over_ = is_over_ || (pass_ && sample >= until_); }

  /// Whether all buses wait for a later sample.
  [[nodiscard]] bool are_waiting(uint64_t sample) const;
  /// Whether time may pass beyond a sample.
  [[nodiscard]] bool are_done(uint64_t sample) const;

 private:
  const bool is_held_;
  bool is_ready_ = false;
  uint64_t executions_ = 0;
  std::map<uint64_t, uint64_t> buses_;  ///< The sample that each waits for.
  std::optional<PassWish> pass_;        ///< The last one.
  uint64_t until_ = 0;                  ///< The sample at which it is over.
  bool is_over_ = true;
};

}  // namespace engram::datasets::kitchen
