// SPDX-License-Identifier: Apache-2.0
// Why something was done, stopped or failed, and who caused it.
#include "speech/dialogues/known_answer.h"

namespace engram::speech::dialogues {

namespace {

/// Why an execution was begun: the plan, and the words that it follows.
std::vector<ltm::MemoryId> causes_of(const LivedPast& past, const Actions& actions) {
  std::vector<ltm::MemoryId> causes;
  for (const LivedAction* action : actions) {
    if (const LivedWords* words = past.command_of(*action); words != nullptr)
      causes.push_back(words->id);
    if (const LivedPlan* plan = past.plan_of(*action); plan != nullptr) causes.push_back(plan->id);
  }
  return causes;
}

void add_why(const AnswerList& list, const Asked& base) {
  const Actions all = list.actions(base.skill, base.thing, base.place);
  if (all.empty()) return;
  const auto add = [&](const char* which, const Actions& asked_about) {
    const std::vector<ltm::MemoryId> causes = causes_of(list.past, asked_about);
    if (causes.empty()) return;
    const LivedWords* words = list.past.command_of(*asked_about.back());
    Asked asked = base;
    asked.what = "why_event";
    asked.which = which;
    list.add("explanations", asked,
             answers::Reason{words == nullptr ? "it was planned" : words->text, causes}, causes);
  };
  // Any of them may be meant; each has its cause.
  add("", all);
  if (all.size() > 1) {
    add("first", {all.front()});
    add("last", {all.back()});
  }
}

void add_stops(const AnswerList& list) {
  const Actions stopped = with_outcome(list.actions("any"), "stop");
  if (stopped.empty()) {
    list.add_unknown("never_stopped", {});
    return;
  }
  std::vector<ltm::MemoryId> causes;
  std::vector<std::string> speakers;
  for (const LivedAction* action : stopped)
    for (const ltm::MemoryId& id : action->stopped_by) {
      causes.push_back(id);
      if (const LivedWords* words = list.past.words_of(id); words != nullptr)
        speakers.push_back(words->speaker);
    }
  if (causes.empty()) return;
  list.add("explanations", {.what = "why_stopped", .skill = "any", .outcome = "stop"},
           answers::Reason{stopped.back()->reason, causes}, causes);
  for (const LivedAction* action : stopped)
    if (!action->stopped_by.empty() &&
        with_outcome(list.actions(action->skill, action->thing), "stop").size() == 1)
      list.add("explanations",
               {.what = "why_stopped_thing",
                .skill = action->skill,
                .outcome = "stop",
                .thing = action->thing},
               answers::Reason{action->reason, action->stopped_by}, action->stopped_by);
  if (!speakers.empty())
    list.add("explanations", {.what = "who_stopped"}, names_of(speakers), causes);
}

/// Why something failed: what was measured at its end.
void add_failures(const AnswerList& list) {
  const Actions failed = with_outcome(list.actions("any"), "failure");
  for (const LivedAction* action : failed) {
    // Any of several may be meant, and is asked about once.
    const Actions alike = with_outcome(list.actions(action->skill, action->thing), "failure");
    if (alike.back() != action) continue;
    list.add("explanations",
             {.what = "why_failed",
              .skill = action->skill,
              .outcome = "failure",
              .thing = action->thing},
             answers::Reason{action->reason, over_ids(alike)}, over_ids(alike));
  }
  if (!failed.empty())
    list.add("explanations", {.what = "why_failed_any", .outcome = "failure", .which = "last"},
             answers::Reason{failed.back()->reason, {*failed.back()->over}},
             {*failed.back()->over});
  for (const std::string& thing : list.things()) {
    const Actions picks = list.actions("pick", thing);
    // The second attempt follows from how the first one ended.
    if (picks.size() != 2 || picks[0]->plan != picks[1]->plan || !picks[0]->over) continue;
    std::vector<ltm::MemoryId> links{*picks[0]->over};
    links.insert(links.end(), picks[0]->stopped_by.begin(), picks[0]->stopped_by.end());
    std::vector<ltm::MemoryId> shown = links;
    shown.push_back(picks[0]->begun);
    list.add("explanations", {.what = "why_again", .skill = "pick", .thing = thing},
             answers::Reason{picks[0]->reason, std::move(links)}, std::move(shown));
  }
}

/// Why something failed that never did.
void add_no_failures(const AnswerList& list) {
  std::vector<Asked> bases;
  for (const std::string& thing : list.things())
    for (const char* skill : {"pick", "place"}) bases.push_back({.skill = skill, .thing = thing});
  for (const auto& [place, pose] : list.past.places)
    bases.push_back({.skill = "navigate", .place = place});
  for (const Asked& base : bases) {
    const Actions all = list.actions(base.skill, base.thing, base.place);
    if (!all.empty() && are_all_done(all)) list.add_unknown("never_failed", base);
  }
}

}  // namespace

void add_reason_answers(const AnswerList& list) {
  for (const std::string& thing : list.things())
    for (const char* skill : {"pick", "place", "look"})
      add_why(list, {.skill = skill, .thing = thing});
  for (const auto& [place, pose] : list.past.places) {
    add_why(list, {.skill = "navigate", .place = place});
    for (const std::string& thing : list.things())
      add_why(list, {.skill = "place", .thing = thing, .place = place});
  }
  add_stops(list);
  add_failures(list);
  add_no_failures(list);
}

}  // namespace engram::speech::dialogues
