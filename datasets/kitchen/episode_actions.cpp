// SPDX-License-Identifier: Apache-2.0
#include <utility>

#include "datasets/kitchen/entities.h"
#include "datasets/kitchen/episode.h"
#include "datasets/kitchen/recorded_skills.h"

namespace engram::datasets::kitchen {

void Episode::plan(const Task& task, const ltm::MemoryId& command) {
  const ThingClass& type = *world_.layout().things[task.thing].type;
  const ltm::MemoryId object = entities::object(type);
  ::kitchen::Plan plan;
  plan.goal = fmt::format("{} on {}", type.spoken_name, place_of(task.to).spoken_name);
  plan.command = command;
  plan.steps.resize(5);
  const std::array<const char*, 5> skills{"look", "navigate", "pick", "navigate", "place"};
  for (size_t i = 0; i < skills.size(); ++i) {
    ::kitchen::PlanStep& step = plan.steps[i];
    step.skill = skills.at(i);
    step.object = object;
    if (i > 0) step.surface = entities::surface(i < 3 ? task.from : task.to);
  }
  plan_id_ = reporter_.report_plan(sample_, plan);
}

Episode::Running Episode::begin(const Task& task, const std::string& skill,
                                std::optional<Surface> surface) {
  const Time now = reporter_.time_of(sample_);
  const ltm::MemoryId object = entities::object(*world_.layout().things[task.thing].type);
  Running running{.skill = skill, .thing = task.thing};
  ::kitchen::Action& action = running.action;
  if (skill == "pick" || skill == "place") action.hand = to_string(task.hand);
  if (surface) action.surface = entities::surface(*surface);
  action.object_before = object.at(now).instance(0);
  action.plan = plan_id_;
  const facts::Links links = reporter_.links_at(now);
  action.image = links.image;
  action.joints = links.joints;
  action.platform = links.platform;
  action.number = actions_++;
  if (is_over()) return running;

  const ::skill::ExecutionRequest request =
      recorded_request(skill, object, action.surface, action.hand, plan_id_);
  action.skill = request.skill;
  action.stage = ::skill::Stage::STARTED;
  action.outcome = Outcome::RUNNING;
  action.started = now;
  action.request = reporter_.report_request(sample_, skill, request);
  action.executable = entities::executable(skill).at(reporter_.time_of(0)).instance(0);
  action.parameters = request.parameters;
  action.inputs = {*action.object_before};
  if (action.surface) action.inputs.push_back(*action.surface);
  action.result = "{}";
  action.running = {now};
  const ltm::MemoryId begun = reporter_.report_action(sample_, skill, action);
  // What is told at its end.
  action.stage = ::skill::Stage::ENDED;
  action.execution = begun;
  action.running.clear();
  return running;
}

void Episode::end(Running& running, Outcome outcome, const std::string& reason,
                  const std::optional<ltm::MemoryId>& stopped_by) {
  if (is_over()) return;
  const Time now = reporter_.time_of(sample_);
  ::kitchen::Action& action = running.action;
  action.ended = now;
  action.outcome = outcome;
  action.reason = reason;
  action.object_after =
      entities::object(*world_.layout().things[running.thing].type).at(now).instance(0);
  action.results = {*action.object_after};
  if (stopped_by) action.stopped_by = {*stopped_by};
  reporter_.report_action(sample_, running.skill, action);
  if (outcome == Outcome::SUCCESS) ++summary_.succeeded;
  if (outcome == Outcome::FAILURE) ++summary_.failed;
  if (outcome == Outcome::STOP) ++summary_.stopped;
}

}  // namespace engram::datasets::kitchen
