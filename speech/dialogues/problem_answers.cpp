// SPDX-License-Identifier: Apache-2.0
// What failed, was stopped and was tried again.
#include <set>

#include "speech/dialogues/known_answer.h"

namespace engram::speech::dialogues {

namespace {

void add_failed(const AnswerList& list, const std::string& when, const std::string& words,
                const Actions& all) {
  const Actions failed = with_outcome(all, "failure");
  const Actions stopped = with_outcome(all, "stop");
  const auto add = [&](const char* what, AnswerValue value) -> KnownAnswer& {
    KnownAnswer& known = list.add("problems", {.what = what, .outcome = "failure", .when = when},
                                  std::move(value), all_ids(failed));
    known.slots["when"] = words;
    if (words == " today" || words == " yesterday") known.slots["day"] = words.substr(1);
    return known;
  };
  add("how_many_failures", answers::Count{static_cast<int64_t>(failed.size())});
  if (failed.empty()) {
    // To have been stopped is a problem for some and none for others.
    if (stopped.empty()) {
      add("any_failure", answers::YesNo{false});
      if (!all.empty() && are_all_done(all)) {
        KnownAnswer& fine = add("did_everything_succeed", answers::YesNo{true});
        fine.evidence = all_ids(all);
      }
    }
    return;
  }
  // To name them says that there were some.
  add("any_failure", answers::YesNo{true}).also = {events_of(failed)};
  add("did_everything_succeed", answers::YesNo{false});
  KnownAnswer& what = add("what_failed", events_of(failed));
  Actions both;
  for (const LivedAction* action : all)
    if (action->outcome == "failure" || action->outcome == "stop") both.push_back(action);
  what.also = {events_of(both)};
  // Of a single failure, what was measured says what went wrong.
  if (both.size() == 1) what.also.push_back(answers::Reason{failed[0]->reason, {*failed[0]->over}});
  // Of a single one nobody would ask which was the first.
  if (failed.size() > 1) {
    add("first_failure", events_of({failed.front()})).asked.which = "first";
    add("last_failure", events_of({failed.back()})).asked.which = "last";
  }
  // Whoever asks when it happened may mean its begin or its end.
  KnownAnswer& when_first = add("when_first_failure", answers::Moment{*failed.front()->ended});
  when_first.asked.which = "first";
  when_first.also = {answers::Moment{failed.front()->started},
                     answers::Span{.from = failed.front()->started, .to = *failed.front()->ended}};
}

void add_failed_things(const AnswerList& list) {
  for (const char* skill : {"pick", "place"}) {
    const Actions failed = with_outcome(list.actions(skill), "failure");
    std::vector<std::string> names;
    for (const LivedAction* action : failed) names.push_back(action->thing);
    if (!names.empty())
      list.add("problems", {.what = "things_failed", .skill = skill, .outcome = "failure"},
               names_of(names), all_ids(failed));
  }
  for (const char* skill : {"pick", "look"}) {
    const Actions failed = with_outcome(list.actions(skill), "failure");
    list.add("problems", {.what = "how_many_failures", .skill = skill, .outcome = "failure"},
             answers::Count{static_cast<int64_t>(failed.size())}, all_ids(failed));
  }
}

/// Whether it worked to pick up or put down a thing, and how often that was tried.
void add_attempts(const AnswerList& list, const char* skill) {
  for (const std::string& thing : list.things()) {
    const Actions tries = list.actions(skill, thing);
    if (tries.empty() || !with_outcome(tries, "running").empty()) continue;
    const Actions failed = with_outcome(tries, "failure");
    const Actions done = with_outcome(tries, "success");
    const Asked base{.skill = skill, .thing = thing};
    const auto asked = [&](const char* what) { return asked_of(base, what); };
    // Whoever was only stopped did not fail, and did not succeed.
    if (failed.size() + done.size() == tries.size())
      list.add("problems", asked("did_fail"), answers::YesNo{!failed.empty()},
               failed.empty() ? all_ids(done) : all_ids(failed));
    list.add("problems", asked("succeeded_eventually"),
             answers::YesNo{tries.back()->outcome == "success"}, all_ids(tries));
    // Of several tasks nobody knows which one is meant.
    if (tries.front()->plan == tries.back()->plan)
      list.add("problems", asked("how_many_attempts"),
               answers::Count{static_cast<int64_t>(tries.size())}, begun_ids(tries));
    if (failed.empty() || failed.size() + done.size() != tries.size()) continue;
    const LivedAction* first = failed.front();
    Actions later;
    for (const LivedAction* action : tries)
      if (action->started > first->started && action->plan == first->plan) later.push_back(action);
    // Whether a try of another task is meant, nobody knows.
    if (later.empty() && tries.back() != first) continue;
    std::vector<ltm::MemoryId> evidence = all_ids(failed);
    for (const ltm::MemoryId& id : begun_ids(later)) evidence.push_back(id);
    list.add("problems", asked("retried"), answers::YesNo{!later.empty()}, evidence);
  }
}

void add_interruptions(const AnswerList& list) {
  const Actions stopped = with_outcome(list.actions("any"), "stop");
  std::vector<ltm::MemoryId> ids = all_ids(stopped);
  for (const LivedAction* action : stopped)
    ids.insert(ids.end(), action->stopped_by.begin(), action->stopped_by.end());
  list.add("problems", {.what = "was_stopped", .outcome = "stop"}, answers::YesNo{!stopped.empty()},
           ids);
  list.add("problems", {.what = "how_many_stops", .outcome = "stop"},
           answers::Count{static_cast<int64_t>(stopped.size())}, ids);
  if (stopped.size() != 1) return;
  list.add("problems", {.what = "what_was_stopped", .outcome = "stop"}, events_of(stopped), ids);
  KnownAnswer& when = list.add("problems", {.what = "when_stopped", .outcome = "stop"},
                               answers::Moment{*stopped[0]->ended}, ids);
  if (!stopped[0]->stopped_by.empty())
    when.also = {answers::Moment{*stopped[0]->stopped_by[0].time()}};
}

}  // namespace

void add_problem_answers(const AnswerList& list) {
  const Actions all = list.actions("any");
  add_failed(list, "all", "", all);
  std::set<Time> days;
  for (const auto& [from, to] : list.past.recordings) days.insert(day_of(from));
  for (const Time day : days) {
    Actions then;
    for (const LivedAction* action : all)
      if (day_of(action->started) == day) then.push_back(action);
    if (then.empty()) continue;
    if (day == day_of(list.now)) add_failed(list, "{day}", " today", then);
    if (day == day_of(list.now) - std::chrono::days(1))
      add_failed(list, "{day}", " yesterday", then);
    if (days.size() > 1) add_failed(list, "{day}", " on " + day_words(day), then);
  }
  add_failed_things(list);
  for (const char* skill : {"pick", "place"}) add_attempts(list, skill);
  add_interruptions(list);
}

}  // namespace engram::speech::dialogues
