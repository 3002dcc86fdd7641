// SPDX-License-Identifier: Apache-2.0
// What would have been done without a stop or a failure.
#include <algorithm>

#include "speech/dialogues/known_answer.h"

namespace engram::speech::dialogues {

namespace {

/// The index of the step that an action carries out; the count of steps if it is none of them.
size_t step_of(const LivedPlan& plan, const LivedAction& action) {
  const auto found = std::find_if(plan.steps.begin(), plan.steps.end(), [&](const LivedStep& step) {
    return step.skill == action.skill && (step.place.empty() || step.place == action.place);
  });
  return static_cast<size_t>(found - plan.steps.begin());
}

std::vector<std::string> skills_from(const LivedPlan& plan, size_t step) {
  std::vector<std::string> skills;
  for (; step < plan.steps.size(); ++step) skills.push_back(plan.steps[step].skill);
  return skills;
}

/// What the plan had after an action that did not end as it should: `suffix` says which action.
void add_rest(const AnswerList& list, const std::string& suffix, const LivedAction& action,
              const std::string& thing) {
  const LivedPlan* plan = list.past.plan_of(action);
  if (plan == nullptr) return;
  const size_t step = step_of(*plan, action);
  if (step + 1 >= plan->steps.size()) return;
  std::vector<ltm::MemoryId> evidence{plan->id};
  // The step itself had begun; some count it as what would have been done.
  const answers::Names rest = names_of(skills_from(*plan, step + 1));
  const answers::Names with_it = names_of(skills_from(*plan, step));
  KnownAnswer& all =
      list.add("what_if", {.what = "what_if_not_" + suffix, .thing = thing}, rest, evidence);
  all.also = {with_it};
  if (thing.empty()) {
    list.add("what_if", {.what = "what_next_if_not_" + suffix},
             answers::Names{{plan->steps[step + 1].skill}}, evidence);
    return;
  }
  list.add("what_if", {.what = "would_have_placed_if_not_" + suffix, .thing = thing},
           answers::YesNo{plan->steps.back().skill == "place"}, evidence);
  const LivedStep& last = plan->steps.back();
  if (last.place.empty()) return;
  list.add("what_if", {.what = "where_to_if_not_" + suffix, .thing = thing},
           answers::Names{{last.place}}, evidence);
}

}  // namespace

void add_instead_answers(const AnswerList& list) {
  for (const char* outcome : {"stop", "failure"}) {
    const Actions all = with_outcome(list.actions("any"), outcome);
    const std::string suffix = outcome == std::string("stop") ? "stopped" : "failed";
    for (const LivedAction* action : all) {
      if (all.size() == 1) add_rest(list, suffix, *action, "");
      // Only one such action with the thing, so that it is clear which is meant.
      if (with_outcome(list.actions("any", action->thing), outcome).size() == 1)
        add_rest(list, suffix + "_thing", *action, action->thing);
    }
  }
}

}  // namespace engram::speech::dialogues
