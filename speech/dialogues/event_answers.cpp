// SPDX-License-Identifier: Apache-2.0
// What was done, how often, in which order and when.
#include <cmath>
#include <set>

#include "speech/dialogues/asked_spans.h"

namespace engram::speech::dialogues {

namespace {

void add_what_was_done(const AnswerList& list, const AskedSpan& span) {
  const Actions all = list.actions("any");
  const Actions begun = begun_within(all, span);
  if (begun.empty()) return;
  Actions during;
  for (const LivedAction* action : all)
    if (action->started <= span.to && action->ended.value_or(span.to) >= span.from)
      during.push_back(action);
  KnownAnswer& known =
      list.add("events", {.what = "what_did_you_do", .skill = "any", .when = span.when},
               events_of(begun), begun_ids(begun));
  known.slots = span.parts;
  known.slots["when"] = span.words;
  // What went on when the span began belongs to it for some and not for others.
  if (during.size() != begun.size()) known.also = {events_of(during)};
  const Actions done = with_outcome(begun, "success");
  if (done.size() == begun.size() || done.empty() || !known.also.empty()) return;
  KnownAnswer& succeeded =
      list.add("events",
               {.what = "what_did_you_do", .skill = "any", .outcome = "success", .when = span.when},
               events_of(done), begun_ids(done));
  succeeded.slots = span.parts;
  succeeded.slots["when"] = span.words;
}

/// How often, whether and when something was done. An attempt that failed was no picking up, and
/// was one: where it matters, the words must say what is meant.
void add_counts(const AnswerList& list, const AskedSpan& span, const Asked& base) {
  const Actions all = begun_within(list.actions(base.skill, base.thing, base.place), span);
  if (!are_clear(list.actions(base.skill, base.thing, base.place), span, list.now)) return;
  const Actions done = with_outcome(all, "success");
  const bool has_running = !with_outcome(all, "running").empty();
  const auto add = [&](const char* what, const char* outcome, AnswerValue value,
                       const Actions& shown) -> KnownAnswer& {
    Asked asked = base;
    asked.what = what;
    asked.outcome = outcome;
    asked.when = span.when;
    KnownAnswer& known = list.add("events", asked, std::move(value), begun_ids(shown));
    known.slots = span.parts;
    known.slots["when"] = span.words;
    return known;
  };
  const auto count = [](const Actions& actions) {
    return answers::Count{static_cast<int64_t>(actions.size())};
  };
  if (has_running) return;
  if (all.size() == done.size()) {
    add("how_often", "", count(all), all);
    add("did_you", "", answers::YesNo{!all.empty()}, all);
  } else {
    add("how_often", "any", count(all), all);
    add("how_often", "success", count(done), done.empty() ? all : done);
    add("did_you", "any", answers::YesNo{true}, all);
    if (done.empty()) add("did_you", "success", answers::YesNo{false}, all);
  }
  if (span.when != "all" || done.empty()) return;
  const auto moment = [&](const char* which, const LivedAction& action) {
    Asked asked = base;
    asked.what = "when_did_you";
    asked.which = which;
    KnownAnswer& known = list.add("events", asked, answers::Moment{action.started}, {action.begun});
    known.evidence.push_back(*action.over);
    known.also = {answers::Moment{*action.ended},
                  answers::Span{.from = action.started, .to = *action.ended}};
  };
  if (all.size() == 1) moment("", *all.front());
  // An attempt that failed before the first or after the last might be meant.
  if (all.size() > 1 && all.front() == done.front()) moment("first", *all.front());
  if (all.size() > 1 && all.back() == done.back()) moment("last", *all.back());
}

/// The ways to name an action that fit no other one.
std::vector<Asked> names_of_one(const AnswerList& list, const LivedAction& action) {
  const Asked of_thing{.skill = action.skill, .thing = action.thing};
  Asked at_place = of_thing;
  at_place.place = action.place;
  const Asked of_drive{.skill = action.skill, .place = action.place};
  std::vector<Asked> names;
  if (action.skill == "pick") names = {of_thing};
  if (action.skill == "place") names = {of_thing, at_place};
  if (action.skill == "navigate") names = {of_drive};
  std::erase_if(names, [&](const Asked& name) {
    return (name.thing.empty() && name.place.empty()) ||
           list.actions(name.skill, name.thing, name.place).size() != 1;
  });
  return names;
}

void add_neighbours(const AnswerList& list) {
  const Actions all = list.actions("any");
  for (size_t i = 0; i < all.size(); ++i) {
    const LivedAction& action = *all[i];
    if (action.outcome != "success") continue;
    const auto is_near = [&](size_t other) {
      return std::abs(to_seconds(all[other]->started - action.started)) < 60;
    };
    for (Asked asked : names_of_one(list, action)) {
      const auto add = [&](const char* what, size_t other) {
        asked.what = what;
        list.add("events", asked, events_of({all[other]}), {all[other]->begun});
      };
      if (i + 1 < all.size() && is_near(i + 1)) add("after_event", i + 1);
      if (i > 0 && is_near(i - 1)) add("before_event", i - 1);
    }
  }
}

/// The first and the last thing that was done within a span.
void add_ends(const AnswerList& list, const AskedSpan& span) {
  const Actions all = begun_within(list.actions("any"), span);
  if (all.empty() || !are_clear(all, span, list.now)) return;
  const auto add = [&](const char* what, const char* which,
                       const LivedAction* action) -> KnownAnswer& {
    KnownAnswer& known =
        list.add("events", {.what = what, .skill = "any", .which = which, .when = span.when},
                 events_of({action}), {action->begun});
    known.slots = span.parts;
    known.slots["when"] = span.words;
    return known;
  };
  add("first_event", "first", all.front());
  KnownAnswer& last = add("last_event", "last", all.back());
  // What has not ended was not done yet, for some.
  if (!all.back()->ended && all.size() > 1) last.also = {events_of({all[all.size() - 2]})};
}

/// Which thing was picked up or put down first and last, also at a place.
void add_things_at_ends(const AnswerList& list, const std::string& skill,
                        const std::string& place) {
  const Actions all = list.actions(skill, "", place);
  const Actions done = with_outcome(all, "success");
  if (done.empty()) return;
  const auto add = [&](const char* which, const LivedAction& action) {
    list.add("events", {.what = "which_thing", .skill = skill, .which = which, .place = place},
             answers::Names{{action.thing}}, {action.begun, *action.over});
  };
  // What was only tried might be meant.
  if (done.front()->thing == all.front()->thing) add("first", *done.front());
  if (done.back() == all.back()) add("last", *done.back());
}

/// What was done with one thing.
void add_done_with(const AnswerList& list) {
  for (const std::string& thing : list.things()) {
    const Actions all = list.actions("any", thing);
    if (all.empty()) continue;
    KnownAnswer& known = list.add("events", {.what = "what_did_you_do_with", .thing = thing},
                                  events_of(all), begun_ids(all));
    // A drive for it was not done with it, for some; nor was looking for it.
    Actions handled;
    for (const LivedAction* action : all)
      if (action->skill != "navigate") handled.push_back(action);
    known.also = {events_of(handled)};
    std::erase_if(handled, [](const LivedAction* one) { return one->skill == "look"; });
    if (!handled.empty()) known.also.push_back(events_of(handled));
  }
}

void add_things_done(const AnswerList& list) {
  for (const char* skill : {"pick", "place"}) {
    const Actions all = list.actions(skill);
    const Actions done = with_outcome(all, "success");
    std::set<std::string> tried;
    std::set<std::string> names;
    for (const LivedAction* action : all) tried.insert(action->thing);
    for (const LivedAction* action : done) names.insert(action->thing);
    // A thing that was only tried would be right for some.
    if (names.empty() || names != tried) continue;
    const std::vector<std::string> listed(names.begin(), names.end());
    list.add("events", {.what = "which_things", .skill = skill}, names_of(listed), begun_ids(done));
    list.add("events", {.what = "how_many_different_things", .skill = skill},
             answers::Count{static_cast<int64_t>(names.size())}, begun_ids(done));
    for (const auto& [place, pose] : list.past.places) {
      const Actions there = with_outcome(list.actions(skill, "", place), "success");
      std::vector<std::string> those;
      for (const LivedAction* action : there) those.push_back(action->thing);
      if (!those.empty())
        list.add("events", {.what = "which_things", .skill = skill, .place = place},
                 names_of(those), begun_ids(there));
    }
  }
}

}  // namespace

void add_event_answers(const AnswerList& list, uint64_t seed) {
  const std::vector<AskedSpan> spans = asked_spans(list, seed);
  for (const AskedSpan& span : spans) {
    add_what_was_done(list, span);
    for (const std::string& thing : list.things())
      for (const char* skill : {"look", "pick", "place"})
        add_counts(list, span, {.skill = skill, .thing = thing});
    for (const auto& [place, pose] : list.past.places) {
      add_counts(list, span, {.skill = "navigate", .place = place});
      for (const std::string& thing : list.things())
        add_counts(list, span, {.skill = "place", .thing = thing, .place = place});
    }
    for (const char* skill : {"pick", "place", "navigate", "look"})
      add_counts(list, span, {.skill = skill});
  }
  add_neighbours(list);
  for (const AskedSpan& span : spans)
    if (span.when == "all" || span.when == "{day}") add_ends(list, span);
  for (const char* skill : {"pick", "place"}) {
    add_things_at_ends(list, skill, "");
    for (const auto& [place, pose] : list.past.places) add_things_at_ends(list, skill, place);
  }
  add_done_with(list);
  add_things_done(list);
}

}  // namespace engram::speech::dialogues
