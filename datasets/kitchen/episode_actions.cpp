// SPDX-License-Identifier: Apache-2.0
#include <utility>

#include "datasets/kitchen/entities.h"
#include "datasets/kitchen/episode.h"

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
  Running running;
  ::kitchen::Action& action = running.action;
  action.skill = skill;
  action.number = actions_++;
  action.started = now;
  action.outcome = Outcome::RUNNING;
  if (skill == "pick" || skill == "place") action.hand = to_string(task.hand);
  action.plan = plan_id_;
  action.object_before =
      entities::object(*world_.layout().things[task.thing].type).at(now).instance(0);
  if (surface) action.surface = entities::surface(*surface);
  action.image = entities::stereo().at(now).instance(0);
  action.joints = entities::joints().at(now).instance(0);
  action.platform = entities::platform().at(now).instance(0);
  running.thing = task.thing;
  if (!is_over()) reporter_.report_action(sample_, action);
  return running;
}

void Episode::end(Running& running, Outcome outcome, const std::string& reason,
                  std::optional<ltm::MemoryId> stopped_by) {
  if (is_over()) return;
  const Time now = reporter_.time_of(sample_);
  ::kitchen::Action& action = running.action;
  action.ended = now;
  action.outcome = outcome;
  action.reason = reason;
  action.object_after =
      entities::object(*world_.layout().things[running.thing].type).at(now).instance(0);
  action.stopped_by = std::move(stopped_by);
  reporter_.report_action(sample_, action);
  if (outcome == Outcome::SUCCESS) ++summary_.succeeded;
  if (outcome == Outcome::FAILURE) ++summary_.failed;
  if (outcome == Outcome::STOP) ++summary_.stopped;
}

}  // namespace engram::datasets::kitchen
