// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/skill_steps.h"

#include <algorithm>

namespace engram::datasets::kitchen {

Status SkillSteps::take(SkillStep step) {
  switch (step) {
    case SkillStep::kCome:
      is_ready_ = false;
      executions_ = 0;
      buses_.clear();
      // Its successor counts from the beginning.
      pass_.reset();
      is_over_ = true;
      return {};
    case SkillStep::kReady:
      is_ready_ = true;
      return {};
    case SkillStep::kBegin:
      ++executions_;
      return {};
    case SkillStep::kEnd:
      break;
  }
  if (executions_ == 0)
    return failed_precondition("kitchen: an execution ended, and none has begun");
  --executions_;
  // At once: whoever asked for it does the next thing at the sample of the end.
  if (pass_ && pass_->until_end) is_over_ = true;
  return {};
}

Status SkillSteps::pass(const PassWish& wish, uint64_t sample) {
  if (!is_held_)
    return failed_precondition("kitchen: its time is not held, so it passes by itself");
  if (pass_ && pass_->id == wish.id) {
    if (wish.samples == 0) is_over_ = true;
    return {};
  }
  if (!is_over_) return failed_precondition("kitchen: its time passes already for somebody else");
  pass_ = wish;
  until_ = sample + wish.samples;
  is_over_ = wish.samples == 0;
  return {};
}

bool SkillSteps::are_waiting(uint64_t sample) const {
  return std::ranges::all_of(buses_, [&](const auto& one) { return one.second > sample; });
}

bool SkillSteps::are_done(uint64_t sample) const {
  if (!is_ready_ || (is_held_ && is_over_)) return false;
  // An execution whose bus has not waited yet has things to do at this sample.
  return buses_.size() >= executions_ && are_waiting(sample);
}

}  // namespace engram::datasets::kitchen
