// SPDX-License-Identifier: Apache-2.0
// What was asked for, by whom and when, and the steps of plans.
#include "speech/dialogues/known_answer.h"

namespace engram::speech::dialogues {

/// What people asked for: commands that led to a plan.
void add_task_answers(const AnswerList& list) {
  std::vector<const LivedWords*> commands;
  std::vector<ltm::MemoryId> plans;
  for (const auto& [id, plan] : list.past.plans)
    if (const LivedWords* words = plan.command ? list.past.words_of(*plan.command) : nullptr;
        words != nullptr) {
      commands.push_back(words);
      plans.push_back(id);
    }
  if (commands.empty()) return;
  const auto add = [&](const char* which, size_t at) {
    list.add("events", {.what = "what_was_asked", .which = which},
             answers::Reason{commands[at]->text, {commands[at]->id, plans[at]}},
             {commands[at]->id, plans[at]});
  };
  add("first", 0);
  add("last", commands.size() - 1);
  std::vector<std::string> speakers;
  std::vector<ltm::MemoryId> shown;
  for (const LivedWords* words : commands) {
    speakers.push_back(words->speaker);
    shown.push_back(words->id);
  }
  list.add("events", {.what = "who_asked"}, names_of(speakers), shown);
  const LivedPlan& last = list.past.plans.rbegin()->second;
  if (last.id == plans.back()) {
    std::vector<std::string> skills;
    for (const LivedStep& step : last.steps) skills.push_back(step.skill);
    list.add("events", {.what = "plan_steps", .which = "last"}, names_of(skills), {last.id});
    list.add("events", {.what = "how_many_plan_steps", .which = "last"},
             answers::Count{static_cast<int64_t>(last.steps.size())}, {last.id});
  }
  // The plans show how many there were as well as the words do.
  std::vector<ltm::MemoryId> both = shown;
  both.insert(both.end(), plans.begin(), plans.end());
  list.add("events", {.what = "how_many_commands"},
           answers::Count{static_cast<int64_t>(commands.size())}, both);
  for (const std::string& thing : list.things()) {
    std::vector<size_t> asked;
    for (size_t i = 0; i < commands.size(); ++i)
      if (commands[i]->text.find(thing) != std::string::npos) asked.push_back(i);
    if (asked.size() != 1) continue;
    const LivedWords& words = *commands[asked[0]];
    const std::vector<ltm::MemoryId> ids{words.id, plans[asked[0]]};
    list.add("events", {.what = "who_asked", .thing = thing}, answers::Names{{words.speaker}}, ids);
    list.add("events", {.what = "when_asked", .thing = thing}, answers::Moment{words.time}, ids);
  }
}

}  // namespace engram::speech::dialogues
