// SPDX-License-Identifier: Apache-2.0
// How long, how far, with which hand, from where and to where something was done, compared too.
#include <algorithm>
#include <set>

#include "speech/dialogues/known_answer.h"

namespace engram::speech::dialogues {

namespace {

/// Durations that differ by less than this share are equal to a listener.
constexpr double kClearlyLonger = 1.15;
constexpr double kClearly_s = 0.2;
constexpr double kDrive_m = 0.05;  ///< A shorter way is not worth asking about.

/// How far the platform moved from one time to another.
double driven_m(const LivedPast& past, Time from, Time to) {
  auto at = std::lower_bound(past.stands.begin(), past.stands.end(), from,
                             [](const LivedStand& one, Time wanted) { return one.time < wanted; });
  double way = 0;
  for (; at != past.stands.end() && std::next(at) != past.stands.end() && std::next(at)->time <= to;
       ++at)
    way += (std::next(at)->at - at->at).norm();
  return way;
}

/// What is told of one execution; `which` says which of several.
void add_details(const AnswerList& list, Asked base, const char* which, const LivedAction& action) {
  if (!action.over) return;
  base.which = which;
  const auto asked = [&](const char* what) { return asked_of(base, what); };
  KnownAnswer& lasted = list.add("action_detail", asked("how_long"),
                                 answers::Seconds{action.seconds()}, all_ids({&action}));
  lasted.also = {answers::Span{.from = action.started, .to = *action.ended}};
  if (action.skill == "navigate") {
    const double way = driven_m(list.past, action.started, *action.ended);
    if (way > kDrive_m)
      list.add("action_detail", asked("how_far_driven"), answers::Metres{way}, all_ids({&action}));
  }
}

/// The same of the only execution, or of the first and the last.
void add_details_of_ends(const AnswerList& list, const Asked& base, const Actions& all) {
  if (all.empty() || !are_all_done(all)) return;
  if (all.size() == 1) {
    add_details(list, base, "", *all.front());
    return;
  }
  add_details(list, base, "first", *all.front());
  add_details(list, base, "last", *all.back());
}

void add_total_duration(const AnswerList& list, const Asked& base, const Actions& all) {
  if (all.empty() || !are_all_done(all)) return;
  double seconds = 0;
  for (const LivedAction* action : all) seconds += action->seconds();
  list.add("action_detail", asked_of(base, "total_duration"), answers::Seconds{seconds},
           begun_ids(all));
}

void add_handling(const AnswerList& list, const Asked& base, const Actions& all) {
  // Attempts that failed matter only if they were made otherwise.
  if (with_outcome(all, "success").empty() || !with_outcome(all, "running").empty()) return;
  std::set<std::string> hands;
  std::set<std::string> places;
  for (const LivedAction* action : all) {
    hands.insert(action->hand);
    places.insert(action->place);
  }
  if (hands.size() == 1 && !hands.begin()->empty()) {
    KnownAnswer& known = list.add("action_detail", asked_of(base, "which_hand"),
                                  answers::Names{{*hands.begin()}}, all_ids(all));
    known.also = {answers::Names{{*hands.begin() + " hand"}}};
    for (const char* hand : {"left", "right"}) {
      KnownAnswer& was = list.add("action_detail", asked_of(base, "was_hand"),
                                  answers::YesNo{hand == *hands.begin()}, all_ids(all));
      was.slots["hand"] = hand;
    }
  }
  if (base.skill == "look" || !base.place.empty()) return;
  if (places.size() == 1 && !places.begin()->empty())
    list.add("action_detail", asked_of(base, base.skill == "pick" ? "from_where" : "to_where"),
             answers::Names{{*places.begin()}}, all_ids(all));
}

void add_comparisons(const AnswerList& list, const char* skill) {
  const std::vector<std::string> things = list.things();
  for (const std::string& one : things)
    for (const std::string& other : things) {
      const Actions first = list.actions(skill, one);
      const Actions second = list.actions(skill, other);
      if (one == other || first.size() != 1 || second.size() != 1 || !are_all_done(first) ||
          !are_all_done(second))
        continue;
      const auto add = [&](const char* what, bool value) -> KnownAnswer& {
        KnownAnswer& known = list.add("action_detail", {.what = what, .skill = skill, .thing = one},
                                      answers::YesNo{value}, {first[0]->begun, second[0]->begun});
        known.slots["thing2"] = other;
        return known;
      };
      const double ratio = first[0]->seconds() / second[0]->seconds();
      if (ratio > kClearlyLonger || ratio < 1 / kClearlyLonger) add("compare_duration", ratio > 1);
      const bool is_first = first[0]->started < second[0]->started;
      add("compare_order", is_first).also = {answers::Names{{is_first ? one : other}}};
      if (first[0]->hand.empty() || second[0]->hand.empty()) continue;
      add("same_hand", first[0]->hand == second[0]->hand);
    }
}

void add_extremes(const AnswerList& list) {
  const Actions all = list.actions("any");
  std::vector<const LivedAction*> sorted;
  for (const LivedAction* action : all)
    if (action->ended) sorted.push_back(action);
  if (sorted.size() < 3 || sorted.size() != all.size()) return;
  std::sort(sorted.begin(), sorted.end(),
            [](const LivedAction* a, const LivedAction* b) { return a->seconds() > b->seconds(); });
  const auto add = [&](const char* skill) {
    if (sorted.size() > 1 && sorted[0]->seconds() > sorted[1]->seconds() + kClearly_s)
      list.add("action_detail", {.what = "longest_event", .skill = skill}, events_of({sorted[0]}),
               all_ids({sorted[0]}));
  };
  add("any");
  std::erase_if(sorted, [](const LivedAction* one) { return one->skill != "navigate"; });
  add("navigate");
}

/// Where it drove first and last, and how long ago something was done.
void add_ends_of_drives(const AnswerList& list) {
  const Actions drives = list.actions("navigate");
  if (!drives.empty() && are_all_done(drives)) {
    if (drives.size() > 1) {
      add_details(list, {.skill = "navigate"}, "first", *drives.front());
      add_details(list, {.skill = "navigate"}, "last", *drives.back());
    }
    list.add("action_detail", {.what = "to_where", .skill = "navigate", .which = "first"},
             answers::Names{{drives.front()->place}}, all_ids({drives.front()}));
    list.add("action_detail", {.what = "to_where", .skill = "navigate", .which = "last"},
             answers::Names{{drives.back()->place}}, all_ids({drives.back()}));
  }
  const auto add_since = [&](const Actions& all, Asked asked) {
    if (all.empty() || all.back()->outcome != "success") return;
    asked.what = "how_long_since_event";
    asked.which = "last";
    KnownAnswer& since = list.add("action_detail", asked,
                                  answers::Seconds{to_seconds(list.now - *all.back()->ended)},
                                  all_ids({all.back()}));
    since.also = {answers::Seconds{to_seconds(list.now - all.back()->started)}};
  };
  for (const std::string& thing : list.things())
    for (const char* skill : {"pick", "place"})
      add_since(list.actions(skill, thing), {.skill = skill, .thing = thing});
  for (const auto& [place, pose] : list.past.places)
    add_since(list.actions("navigate", "", place), {.skill = "navigate", .place = place});
}

/// Whether something was picked up more often than something else. All attempts of both succeeded.
void add_count_comparisons(const AnswerList& list) {
  for (const std::string& one : list.things())
    for (const std::string& other : list.things()) {
      const Actions first = list.actions("pick", one);
      const Actions second = list.actions("pick", other);
      // Whoever asks about equal ones may want to hear that they are equal.
      if (first.size() == second.size() || first.empty() || second.empty() ||
          !are_all_done(first) || !are_all_done(second))
        continue;
      KnownAnswer& known = list.add(
          "action_detail", {.what = "compare_count", .skill = "pick", .thing = one},
          answers::YesNo{first.size() > second.size()}, {first[0]->begun, second[0]->begun});
      known.slots["thing2"] = other;
    }
}

}  // namespace

void add_detail_answers(const AnswerList& list) {
  for (const std::string& thing : list.things()) {
    std::vector<Asked> bases;
    for (const char* skill : {"pick", "place", "look"})
      bases.push_back({.skill = skill, .thing = thing});
    for (const auto& [place, pose] : list.past.places)
      bases.push_back({.skill = "place", .thing = thing, .place = place});
    for (const Asked& base : bases) {
      const Actions all = list.actions(base.skill, base.thing, base.place);
      add_handling(list, base, all);
      add_details_of_ends(list, base, all);
    }
    add_total_duration(list, {.skill = "look", .thing = thing}, list.actions("look", thing));
  }
  for (const auto& [place, pose] : list.past.places) {
    const Actions drives = list.actions("navigate", "", place);
    add_details_of_ends(list, {.skill = "navigate", .place = place}, drives);
    add_total_duration(list, {.skill = "navigate", .place = place}, drives);
  }
  const Actions drives = list.actions("navigate");
  if (!drives.empty() && are_all_done(drives)) {
    double way = 0;
    for (const LivedAction* drive : drives)
      way += driven_m(list.past, drive->started, *drive->ended);
    list.add("action_detail", {.what = "how_far_driven", .skill = "navigate"}, answers::Metres{way},
             begun_ids(drives));
  }
  add_total_duration(list, {.skill = "navigate"}, drives);
  for (const char* skill : {"pick", "place"}) add_comparisons(list, skill);
  add_count_comparisons(list);
  add_ends_of_drives(list);
  add_extremes(list);
}

}  // namespace engram::speech::dialogues
