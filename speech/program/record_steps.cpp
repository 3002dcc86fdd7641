// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "speech/program/program_run.h"

namespace engram::speech {

void ProgramRun::tell_when() {
  const auto told = [this](Time time, const ltm::MemoryId& id, const char* role) {
    outcome_.value = answers::Moment{time};
    outcome_.cite(id, role);
  };
  if (!outcome_.executions.empty()) {
    told(outcome_.executions.front().started, outcome_.executions.front().start_id, "started");
    outcome_.cite(outcome_.executions.front());
  } else if (!outcome_.words.empty()) {
    told(outcome_.words.front().time, outcome_.words.front().id, "words");
  } else if (!outcome_.plans.empty()) {
    told(outcome_.plans.front().time, outcome_.plans.front().id, "plan");
  } else if (!outcome_.states.empty()) {
    told(outcome_.states.front().time, outcome_.states.front().id, "thing");
  } else if (!refusals_.empty()) {
    told(refusals_.front().time, refusals_.front().id, "refusal");
  } else {
    told(drives_.front().time, drives_.front().id, "drive");
  }
}

Status ProgramRun::tell_who() {
  std::vector<std::string> names;
  const auto name = [&](const SpokenWords& words) {
    if (!words.speaker.empty()) names.push_back(words.speaker);
    outcome_.cite(words.id, "words");
  };
  for (const SpokenWords& words : outcome_.words) name(words);
  for (const TaskPlan& plan : outcome_.plans) {
    const SpokenWords* words = plan.command ? facts_.words_at(*plan.command) : nullptr;
    outcome_.cite(plan.id, "plan");
    if (words != nullptr) name(*words);
  }
  const std::vector<Execution> executions = outcome_.executions;
  for (const Execution& execution : executions) {
    ENGRAM_ASSIGN_OR_RETURN(const auto words, words_of(facts_, execution));
    outcome_.cite(execution.start_id, "started");
    if (!words) continue;
    name(*words);
    outcome_.words.push_back(*words);
  }
  if (names.empty()) miss("nobody's words led to it");
  outcome_.value = names_of(std::move(names));
  return {};
}

void ProgramRun::tell_which(const std::string& what) {
  const KnownWorld& world = facts_.world();
  std::vector<std::string> names;
  const auto add_entity = [&](const std::optional<ltm::MemoryId>& entity) {
    if (entity) names.push_back(world.spoken(*entity));
  };
  for (const Execution& execution : outcome_.executions) {
    outcome_.cite(execution);
    if (what == "thing") add_entity(execution.thing);
    if (what == "place") add_entity(execution.place);
    if (what == "skill") names.push_back(execution.skill);
    if (what == "hand" && !execution.hand.empty()) names.push_back(execution.hand);
  }
  for (const TaskPlan& plan : outcome_.plans) {
    outcome_.cite(plan.id, "plan");
    for (const PlannedStep& step : plan.steps) {
      if (what == "thing") add_entity(step.thing);
      if (what == "place") add_entity(step.place);
      if (what == "skill") names.push_back(step.skill);
    }
  }
  for (const SpokenWords& words : outcome_.words) {
    outcome_.cite(words.id, "words");
    if (what == "person" && !words.speaker.empty()) names.push_back(words.speaker);
  }
  for (const ThingState& state : outcome_.states) {
    outcome_.cite(state);
    if (what == "thing") names.push_back(world.spoken(state.id.entity()));
    if (what == "hand" && !state.held_by.empty()) names.push_back(state.held_by);
    if (what == "colour" && !state.colour.empty()) names.push_back(state.colour);
  }
  if (names.empty()) miss(fmt::format("no {} is told of it", what));
  outcome_.value = names_of(std::move(names));
}

void ProgramRun::tell_how_many(const std::string& what) {
  if (what != "step") {
    tell_which(what);
    if (const auto* names = std::get_if<answers::Names>(&outcome_.value))
      outcome_.value = answers::Count{static_cast<int64_t>(names->value.size())};
    return;
  }
  size_t count = 0;
  for (const TaskPlan& plan : outcome_.plans) {
    outcome_.cite(plan.id, "plan");
    count += plan.steps.size();
  }
  outcome_.value = answers::Count{static_cast<int64_t>(count)};
}

Status ProgramRun::tell_said() {
  for (const TaskPlan& plan : outcome_.plans) {
    outcome_.cite(plan.id, "plan");
    const SpokenWords* words = plan.command ? facts_.words_at(*plan.command) : nullptr;
    if (words != nullptr) outcome_.words.push_back(*words);
  }
  for (const Execution& execution : outcome_.executions) {
    ENGRAM_ASSIGN_OR_RETURN(const auto words, words_of(facts_, execution));
    outcome_.cite(execution.start_id, "started");
    if (words) outcome_.words.push_back(*words);
  }
  answers::Reason said;
  for (const SpokenWords& words : outcome_.words) {
    if (std::find(said.links.begin(), said.links.end(), words.id) != said.links.end()) continue;
    said.value += (said.value.empty() ? "" : " ") + words.text;
    said.links.push_back(words.id);
    outcome_.cite(words.id, "words");
  }
  if (said.links.empty()) miss("nobody's words led to it");
  outcome_.value = std::move(said);
  return {};
}

}  // namespace engram::speech
