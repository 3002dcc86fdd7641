// SPDX-License-Identifier: Apache-2.0
// What was so at a moment: what went on, what was held, where things and the robot were.
#include <algorithm>
#include <map>
#include <random>

#include "speech/dialogues/known_answer.h"

namespace engram::speech::dialogues {

namespace {

constexpr int kTries = 24;

struct AskedMoment {
  Time time{};
  std::string when;   ///< "{time}" or "{ago}".
  std::string words;  ///< "at 8:00:12", "ten seconds ago".
};

std::string number_words(int64_t number) {
  switch (number) {
    case 5:
      return "five";
    case 10:
      return "ten";
    case 15:
      return "fifteen";
    case 20:
      return "twenty";
    case 30:
      return "thirty";
    default:
      return std::to_string(number);
  }
}

/// Whole seconds of the recordings. They are told with the day where it is not the present one.
std::vector<AskedMoment> asked_moments(const AnswerList& list, uint64_t seed) {
  std::vector<AskedMoment> moments;
  std::mt19937_64 random(seed + 1);
  const auto& recordings = list.past.recordings;
  for (int i = 0; i < kTries; ++i) {
    const auto& [from, to] = recordings[random() % recordings.size()];
    const auto seconds = static_cast<uint64_t>(to_seconds(to - from));
    if (seconds < 6) continue;
    const Time at = std::chrono::ceil<std::chrono::seconds>(from) +
                    std::chrono::seconds(2 + random() % (seconds - 4));
    std::string words = "at " + clock_words(at);
    if (day_of(at) == day_of(list.now) - std::chrono::days(1))
      words += " yesterday";
    else if (day_of(at) != day_of(list.now))
      words += " on " + day_words(at);
    moments.push_back({at, "{time}", words});
    if (!list.is_present()) continue;
    const auto ago = 5 * static_cast<int64_t>(1 + random() % 8);
    if (list.now - std::chrono::seconds(ago) > recordings.back().first + std::chrono::seconds(2))
      moments.push_back({list.now - std::chrono::seconds(ago), "{ago}",
                         fmt::format("{} seconds ago",
                                     random() % 2 == 0 ? number_words(ago) : std::to_string(ago))});
  }
  return moments;
}

/// What went on all the time around a moment; null: nothing, or it changed.
const LivedAction* action_around(const LivedPast& past, Time time) {
  for (const LivedAction& action : past.actions)
    if (action.started + kUnclear <= time &&
        time + kUnclear <= action.ended.value_or(past.last_moment()))
      return &action;
  return nullptr;
}

/// The place that the robot stood at all the time around a moment, because it had driven there.
/// Empty: it drove, or nobody knows.
std::string stand_around(const LivedPast& past, Time time, std::vector<ltm::MemoryId>& evidence) {
  const LivedAction* last = nullptr;
  for (const LivedAction& action : past.actions) {
    if (action.skill != "navigate" || action.started > time + kUnclear) continue;
    if (!action.ended || *action.ended + kUnclear > time) return {};
    last = &action;
  }
  if (last == nullptr || last->outcome != "success" || time - last->started > std::chrono::hours(1))
    return {};
  for (const auto& [from, to] : past.recordings)
    if (last->started < from && from <= time) return {};
  evidence = {last->begun, *last->over};
  const auto after =
      std::upper_bound(past.stands.begin(), past.stands.end(), time,
                       [](Time wanted, const LivedStand& one) { return wanted < one.time; });
  if (after != past.stands.begin()) evidence.push_back(std::prev(after)->id);
  return last->place;
}

/// A thing's sight that held all the time around a moment; null: it changed, or is not known.
const LivedSight* sight_around(const LivedPast& past, const std::string& thing, Time time) {
  const LivedSight* at = past.sight_at(thing, time);
  for (const Time other : {time - kUnclear, time + kUnclear}) {
    const LivedSight* beside = past.sight_at(thing, other);
    if (at == nullptr || beside == nullptr || beside->held_by != at->held_by ||
        (beside->at - at->at).norm() > (at->held_by.empty() ? 0.02 : 1.0))
      return nullptr;
  }
  return at;
}

KnownAnswer& add_at(const AnswerList& list, const AskedMoment& moment, Asked asked,
                    AnswerValue value, std::vector<ltm::MemoryId> evidence) {
  asked.when = moment.when;
  KnownAnswer& known =
      list.add("at_a_time", std::move(asked), std::move(value), std::move(evidence));
  known.slots["at"] = moment.words;
  // "8:00:12" of "at 8:00:12", for phrasings that put it otherwise.
  if (moment.when == "{time}") known.slots["time"] = moment.words.substr(3);
  if (moment.when == "{ago}") known.slots["ago"] = moment.words;
  return known;
}

using NamedIds = std::vector<std::pair<std::string, ltm::MemoryId>>;

std::pair<std::vector<std::string>, std::vector<ltm::MemoryId>> unzipped(const NamedIds& all) {
  std::vector<std::string> names;
  std::vector<ltm::MemoryId> ids;
  for (const auto& [name, id] : all) {
    names.push_back(name);
    ids.push_back(id);
  }
  return {std::move(names), std::move(ids)};
}

void add_held_at(const AnswerList& list, const AskedMoment& moment, const NamedIds& held) {
  if (held.empty()) {
    add_at(list, moment, {.what = "was_holding_at"}, answers::YesNo{false}, {}).also = {
        answers::Names{}};
    return;
  }
  const auto [names, ids] = unzipped(held);
  add_at(list, moment, {.what = "held_at"}, names_of(names), ids);
  add_at(list, moment, {.what = "was_holding_at"}, answers::YesNo{true}, ids).also = {
      names_of(names)};
}

void add_things_at(const AnswerList& list, const AskedMoment& moment) {
  NamedIds held;
  std::map<std::string, NamedIds> standing;
  bool is_known = true;
  bool is_clear = list.past.recordings.size() == 1;
  for (const std::string& thing : list.things()) {
    const LivedSight* sight = sight_around(list.past, thing, moment.time);
    if (sight == nullptr) {
      is_known = is_known && list.past.sight_at(thing, moment.time) == nullptr;
      continue;
    }
    if (!sight->held_by.empty()) {
      held.emplace_back(thing, sight->id);
      continue;
    }
    const LivedSight* before = list.past.sight_at(thing, moment.time - kUnclear);
    const LivedSight* after = list.past.sight_at(thing, moment.time + kUnclear);
    if (before->is_visible == sight->is_visible && after->is_visible == sight->is_visible)
      add_at(list, moment, {.what = "was_visible_at", .thing = thing},
             answers::YesNo{sight->is_visible}, {sight->id, before->id, after->id});
    const std::string place = list.past.place_below(*sight);
    is_clear = is_clear && !place.empty();
    if (place.empty()) continue;
    standing[place].emplace_back(thing, sight->id);
    add_at(list, moment, {.what = "where_thing_at", .thing = thing}, answers::Names{{place}},
           {sight->id});
  }
  if (!is_known) return;
  add_held_at(list, moment, held);
  if (!is_clear) return;
  for (const auto& [place, things] : standing) {
    const auto [names, ids] = unzipped(things);
    add_at(list, moment, {.what = "things_on_place_at", .place = place}, names_of(names), ids);
  }
}

/// What is going on while it is asked, and where the robot is.
void add_present(const AnswerList& list) {
  const Actions all = list.actions("any");
  if (!all.empty()) {
    const LivedAction& last = *all.back();
    const bool is_going_on = !last.ended;
    if (list.now - last.ended.value_or(last.started) > kUnclear) {
      KnownAnswer& doing =
          list.add("at_a_time", {.what = "doing_now", .skill = "any", .when = "now"},
                   is_going_on ? events_of({&last}) : AnswerValue(answers::Events{}), {});
      if (is_going_on)
        doing.evidence = {last.begun};
      else
        doing.also = {answers::YesNo{false}, answers::Names{}};
    }
  }
  std::vector<ltm::MemoryId> evidence;
  if (const std::string place = stand_around(list.past, list.now, evidence); !place.empty())
    list.add("at_a_time", {.what = "where_robot_now", .when = "now"}, answers::Names{{place}},
             evidence);
}

}  // namespace

void add_moment_answers(const AnswerList& list, uint64_t seed) {
  if (list.is_present()) add_present(list);
  for (const AskedMoment& moment : asked_moments(list, seed)) {
    if (const LivedAction* action = action_around(list.past, moment.time); action != nullptr) {
      add_at(list, moment, {.what = "doing_at", .skill = "any"}, events_of({action}),
             {action->begun});
      if (action->skill == "pick" || action->skill == "place")
        add_at(list, moment, {.what = "handled_at"}, answers::Names{{action->thing}},
               {action->begun});
      for (const char* skill : {"navigate", "pick"})
        add_at(list, moment, {.what = "was_doing_at", .skill = skill},
               answers::YesNo{action->skill == skill}, {action->begun});
    }
    std::vector<ltm::MemoryId> evidence;
    if (const std::string place = stand_around(list.past, moment.time, evidence); !place.empty()) {
      add_at(list, moment, {.what = "where_robot_at"}, answers::Names{{place}}, evidence);
      for (const auto& [other, pose] : list.past.places)
        add_at(list, moment, {.what = "was_robot_at", .place = other},
               answers::YesNo{other == place}, evidence);
    }
    add_things_at(list, moment);
  }
}

}  // namespace engram::speech::dialogues
