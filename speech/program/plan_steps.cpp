// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "speech/program/program_run.h"

namespace engram::speech {

namespace {

/// The step of its plan that an execution carries out; nothing where it is none. A second attempt
/// is of the same step, so only the step tells, not how many executions there were.
std::optional<size_t> step_of(const TaskPlan& plan, const std::vector<const Execution*>& all,
                              const Execution& execution) {
  std::optional<size_t> step;
  for (const Execution* one : all) {
    const Execution& other = *one;
    if (other.plan != execution.plan || other.started > execution.started) continue;
    const auto carries = [&](size_t index) {
      const PlannedStep& planned = plan.steps[index];
      return planned.skill == other.skill && (!planned.place || planned.place == other.place) &&
             (!planned.thing || planned.thing == other.thing);
    };
    std::optional<size_t> found;
    for (size_t i = step.value_or(0); i < plan.steps.size() && !found; ++i)
      if (carries(i)) found = i;
    for (size_t i = 0; i < plan.steps.size() && !found; ++i)
      if (carries(i)) found = i;
    if (found) step = found;
    if (other.start_id == execution.start_id) return found;
  }
  return {};
}

}  // namespace

void ProgramRun::tell_retried() {
  const std::vector<Execution> asked = outcome_.executions;
  bool is_retried = false;
  for (const Execution& execution : asked) {
    outcome_.cite(execution);
    for (const Execution* later : facts_.executions()) {
      if (later->started <= execution.started ||
          (execution.has_known_end() && later->started < *execution.ended) ||
          later->skill != execution.skill || later->thing != execution.thing ||
          later->plan != execution.plan || (!execution.plan && later->place != execution.place))
        continue;
      is_retried = true;
      outcome_.cite(*later);
      outcome_.executions.push_back(*later);
      break;
    }
  }
  outcome_.value = answers::YesNo{is_retried};
}

/// The steps of the plan that had not begun when it ended.
void ProgramRun::tell_instead(const ProgramStep& asked) {
  const Execution execution = outcome_.executions.back();
  const TaskPlan* plan = execution.plan ? facts_.plan_at(*execution.plan) : nullptr;
  const auto step = plan == nullptr ? std::nullopt : step_of(*plan, facts_.executions(), execution);
  if (!step || *step + 1 >= plan->steps.size()) {
    miss(plan == nullptr ? "no plan is told of it" : "its plan had no further step");
    return;
  }
  outcome_.steps.assign(plan->steps.begin() + static_cast<ptrdiff_t>(*step) + 1, plan->steps.end());
  outcome_.plans.push_back(*plan);
  outcome_.cite(plan->id, "plan");
  outcome_.cite(execution);
  std::vector<std::string> skills;
  for (const PlannedStep& next : outcome_.steps) skills.push_back(next.skill);
  if (asked.kind == StepKind::kInsteadNext) {
    outcome_.steps.resize(1);
    skills.resize(1);
  }
  if (asked.kind == StepKind::kInsteadHas) {
    const auto is_asked_for = [&](const std::string& skill) {
      return ("," + asked.argument->text + ",").find("," + skill + ",") != std::string::npos;
    };
    outcome_.value = answers::YesNo{std::any_of(skills.begin(), skills.end(), is_asked_for)};
    return;
  }
  if (asked.kind == StepKind::kInsteadWhere) {
    const PlannedStep& last = outcome_.steps.back();
    if (!last.place) {
      miss("its plan leads to no place");
      return;
    }
    outcome_.value = answers::Names{{facts_.world().spoken(*last.place)}};
    return;
  }
  outcome_.value = names_of(std::move(skills));
}

}  // namespace engram::speech
