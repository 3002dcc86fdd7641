// SPDX-License-Identifier: Apache-2.0
#include "cli/stepped_skills.h"

#include <cmath>
#include <thread>
#include <utility>

#include "datasets/kitchen/robot_bus.h"
#include "ltm/core/log.h"

namespace engram::cli {

namespace {

namespace kitchen = datasets::kitchen;

constexpr const char* kPassSkill = R"(name: pass
doc: Lets time pass in a kitchen whose time is held. What was asked for before begins first.
parameters:
  seconds: {type: double, unit: s, min: 0, max: 3600, doc: Of the time of the kitchen.}
  until_end: {type: bool, default: false, doc: Ends as soon as another skill has ended.}
resources: [time]
)";

}  // namespace

Status SteppedProvider::add(std::string_view description, SkillFunction function) {
  return provider_->add(description, [this, function = std::move(function)](SkillRun& run) {
    if (const Status begun = steps_.tell(kitchen::SkillStep::kBegin); !begun.ok())
      return SkillEnd::failure(begun.message());
    ++taken_up_;
    SkillEnd end = SkillEnd::failure("an exception");
    try {
      end = function(run);
    } catch (const std::exception& failure) {
      end.reason = failure.what();
    }
    // Before the body may go on, so that nobody counts an execution that is over.
    --taken_up_;
    if (const Status ended = steps_.tell(kitchen::SkillStep::kEnd); !ended.ok())
      log::debug("skills: {}", ended.message());
    return end;
  });
}

Status SteppedProvider::add_pass() {
  return provider_->add(kPassSkill, [this](SkillRun& run) { return pass(run); });
}

SkillEnd SteppedProvider::pass(SkillRun& run) {
  constexpr std::chrono::milliseconds kLook{1};
  // The server told of what was asked for before, in its order; each has a thread of its own, which
  // may not have begun. Those that have ended are there a moment longer.
  while (provider_->running() > taken_up_ + 1) {
    if (run.stop().stop_requested()) return SkillEnd::stopped();
    std::this_thread::sleep_for(kLook);
  }
  const auto seconds = run.parameters().at("seconds")->get_if<double>();
  const auto until_end = run.parameters().at("until_end")->get_if<bool>();
  if (seconds == nullptr || until_end == nullptr)
    return SkillEnd::failure("pass: needs seconds, a number, and until_end, true or false");
  const auto samples = static_cast<uint64_t>(std::llround(*seconds * kitchen::RobotBus::kRate_hz));
  const auto sample = steps_.pass({++passes_, samples, *until_end}, run.stop());
  if (sample.status().code() == StatusCode::kCancelled && run.stop().stop_requested())
    return SkillEnd::stopped("told to stop");
  if (!sample.ok()) return SkillEnd::failure(sample.status().message());
  SkillEnd end = SkillEnd::success(fmt::format("time stands at sample {}", *sample));
  end.result = idf::Dict{{"sample", static_cast<int64_t>(*sample)}};
  return end;
}

}  // namespace engram::cli
