// SPDX-License-Identifier: Apache-2.0
// Where things are, were seen and are held.
#include <algorithm>
#include <cmath>
#include <map>

#include "speech/dialogues/known_answer.h"

namespace engram::speech::dialogues {

namespace {

/// A thing that moved by less stands where it stood, or was pushed aside.
constexpr double kMoved_m = 0.3;
constexpr double kStayed_m = 0.05;

AnswerValue place_value(const std::string& place) {
  return answers::Names{{place}};
}

/// The things that a question about the present may be about: those of the last recording.
std::vector<std::pair<std::string, const LivedSight*>> present_things(const AnswerList& list) {
  std::vector<std::pair<std::string, const LivedSight*>> present;
  for (const std::string& thing : list.things())
    if (const LivedSight* sight = list.past.sight_at(thing, list.now); sight != nullptr)
      present.emplace_back(thing, sight);
  return present;
}

bool is_clearly_somewhere(const LivedPast& past, const LivedSight& sight) {
  return !sight.held_by.empty() || !past.place_below(sight).empty();
}

/// Who holds a thing: a hand, or nobody.
void add_who_holds(const AnswerList& list, const std::string& thing, const LivedSight& sight) {
  if (sight.held_by.empty()) {
    KnownAnswer& nobody = list.add("objects", {.what = "who_holds", .when = "now", .thing = thing},
                                   answers::Names{}, {sight.id});
    nobody.also = {answers::YesNo{false}};
    return;
  }
  KnownAnswer& who = list.add("objects", {.what = "who_holds", .when = "now", .thing = thing},
                              answers::Names{{sight.held_by}}, {sight.id});
  who.also = {answers::Names{{sight.held_by + " hand"}}, answers::Names{{"robot"}}};
}

void add_where_now(const AnswerList& list, const std::string& thing, const LivedSight& sight) {
  if (sight.held_by.empty()) {
    const std::string place = list.past.place_below(sight);
    list.add("objects", {.what = "where_now", .when = "now", .thing = thing}, place_value(place),
             {sight.id});
    for (const auto& [other, pose] : list.past.places)
      list.add("objects",
               {.what = "is_thing_on_place", .when = "now", .thing = thing, .place = other},
               answers::YesNo{other == place}, {sight.id});
  } else {
    // A hand is called by its side, and by "right hand" too.
    KnownAnswer& where = list.add("objects", {.what = "where_now", .when = "now", .thing = thing},
                                  answers::Names{{sight.held_by}}, {sight.id});
    where.also = {answers::Names{{sight.held_by + " hand"}}};
    KnownAnswer& hand =
        list.add("objects", {.what = "which_hand_holds", .when = "now", .thing = thing},
                 answers::Names{{sight.held_by}}, {sight.id});
    hand.also = where.also;
  }
  add_who_holds(list, thing, sight);
  list.add("objects", {.what = "is_held", .when = "now", .thing = thing},
           answers::YesNo{!sight.held_by.empty()}, {sight.id});
  list.add("objects", {.what = "is_visible", .when = "now", .thing = thing},
           answers::YesNo{sight.is_visible}, {sight.id});
  if (!sight.colour.empty())
    list.add("objects", {.what = "colour", .thing = thing}, answers::Names{{sight.colour}},
             {sight.id});
}

void add_places_now(const AnswerList& list) {
  const auto present = present_things(list);
  for (const auto& [thing, sight] : present)
    if (!is_clearly_somewhere(list.past, *sight)) return;
  std::vector<std::string> visible;
  std::vector<ltm::MemoryId> evidence;
  for (const auto& [thing, sight] : present)
    if (sight->is_visible) {
      visible.push_back(thing);
      evidence.push_back(sight->id);
    }
  std::vector<std::string> held;
  std::vector<ltm::MemoryId> holding;
  for (const auto& [thing, sight] : present)
    if (!sight->held_by.empty()) {
      held.push_back(thing);
      holding.push_back(sight->id);
    }
  KnownAnswer& hands =
      list.add("objects", {.what = "held_now", .when = "now"}, names_of(held), holding);
  if (held.empty()) hands.also = {answers::YesNo{false}};
  KnownAnswer& eyes =
      list.add("objects", {.what = "things_visible", .when = "now"}, names_of(visible), evidence);
  if (visible.empty()) eyes.also = {answers::YesNo{false}};
  // What was left there in recordings of before may be meant or not, so only one recording is asked
  // about.
  if (list.past.recordings.size() > 1) return;
  for (const auto& [place, pose] : list.past.places) {
    std::vector<std::string> standing;
    std::vector<ltm::MemoryId> shown;
    for (const auto& [thing, sight] : present)
      if (sight->held_by.empty() && list.past.place_below(*sight) == place) {
        standing.push_back(thing);
        shown.push_back(sight->id);
      }
    if (standing.empty()) continue;
    list.add("objects", {.what = "things_on_place", .when = "now", .place = place},
             names_of(standing), shown);
    list.add("objects", {.what = "how_many_things_on_place", .when = "now", .place = place},
             answers::Count{static_cast<int64_t>(standing.size())}, shown);
    list.add("objects", {.what = "is_anything_on", .when = "now", .place = place},
             answers::YesNo{true}, shown);
  }
}

/// Where a thing was seen. Whoever asks that wants to find it, so the last place is an answer, and
/// so are all of them.
void add_where_seen(const AnswerList& list, const std::string& thing,
                    const std::vector<const LivedSight*>& seen) {
  std::map<std::string, ltm::MemoryId> last_sights;
  for (const LivedSight* sight : seen) {
    if (!sight->held_by.empty()) continue;
    const std::string place = list.past.place_below(*sight);
    // Where it cannot be said of each sight, all of them cannot be told.
    if (place.empty()) return;
    last_sights.insert_or_assign(place, sight->id);
  }
  if (!seen.back()->held_by.empty()) return;
  const std::string last = list.past.place_below(*seen.back());
  std::vector<std::string> places;
  std::vector<ltm::MemoryId> evidence;
  for (const auto& [place, id] : last_sights) {
    places.push_back(place);
    evidence.push_back(id);
  }
  KnownAnswer& where = list.add("objects", {.what = "where_seen", .thing = thing},
                                place_value(last), std::move(evidence));
  where.also = {names_of(std::move(places))};
}

void add_sights(const AnswerList& list, const std::string& thing,
                const std::vector<LivedSight>& sights) {
  std::vector<const LivedSight*> seen;
  for (const LivedSight& sight : sights)
    if (sight.is_visible) seen.push_back(&sight);
  if (seen.empty()) {
    list.add_unknown("never_seen", {.when = "all", .thing = thing});
    return;
  }
  const LivedSight* first = seen.front();
  const LivedSight* last = seen.back();
  list.add("objects", {.what = "when_seen_first", .which = "first", .thing = thing},
           answers::Moment{first->time}, {first->id});
  // "Now" is a better answer to when something was seen that is still in sight.
  if (list.now - last->time > std::chrono::seconds(2)) {
    list.add("objects", {.what = "when_seen_last", .which = "last", .thing = thing},
             answers::Moment{last->time}, {last->id});
    list.add("objects", {.what = "how_long_since_seen", .which = "last", .thing = thing},
             answers::Seconds{to_seconds(list.now - last->time)}, {last->id});
  }
  list.add("objects", {.what = "was_seen", .thing = thing}, answers::YesNo{true},
           {first->id, last->id});
  if (const std::string place = list.past.place_below(*last); !place.empty())
    list.add("objects", {.what = "where_last_seen", .which = "last", .thing = thing},
             place_value(place), {last->id});
  add_where_seen(list, thing, seen);
}

void add_moves(const AnswerList& list, const std::string& thing,
               const std::vector<LivedSight>& sights) {
  if (list.past.recordings.size() > 1) return;
  double farthest = 0;
  for (const LivedSight& sight : sights)
    farthest = std::max(farthest, (sight.at - sights.front().at).norm());
  const double now = (sights.back().at - sights.front().at).norm();
  if (farthest > kStayed_m && (farthest < kMoved_m || now < kMoved_m)) return;
  KnownAnswer& moved =
      list.add("objects", {.what = "was_moved", .thing = thing},
               answers::YesNo{farthest >= kMoved_m}, {sights.front().id, sights.back().id});
  for (const LivedAction* action : list.actions("any", thing)) {
    moved.evidence.push_back(action->begun);
    if (action->over) moved.evidence.push_back(*action->over);
  }
}

}  // namespace

void add_object_answers(const AnswerList& list) {
  std::vector<std::string> seen;
  std::vector<ltm::MemoryId> evidence;
  for (const auto& [thing, sights] : list.past.sights) {
    add_sights(list, thing, sights);
    add_moves(list, thing, sights);
    const auto visible = std::find_if(sights.begin(), sights.end(),
                                      [](const LivedSight& one) { return one.is_visible; });
    if (visible == sights.end()) continue;
    seen.push_back(thing);
    evidence.push_back(visible->id);
    const auto last = std::find_if(sights.rbegin(), sights.rend(),
                                   [](const LivedSight& one) { return one.is_visible; });
    evidence.push_back(last->id);
  }
  if (!seen.empty()) list.add("objects", {.what = "things_seen"}, names_of(seen), evidence);
  if (!list.is_present()) return;
  for (const auto& [thing, sight] : present_things(list))
    if (is_clearly_somewhere(list.past, *sight)) add_where_now(list, thing, *sight);
  add_places_now(list);
}

}  // namespace engram::speech::dialogues
