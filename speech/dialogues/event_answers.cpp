// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <map>
#include <random>
#include <set>

#include "speech/dialogues/known_answer.h"

namespace engram::speech::dialogues {

namespace {

/// An action so near to the edge of a span of time may be meant or not.
constexpr Duration kEdge = std::chrono::milliseconds(600);

/// A span of time, and how people put it.
struct AskedSpan {
  std::string when;   ///< As Asked::when.
  std::string words;  ///< " yesterday"; empty: always.
  Time from{};
  Time to{};
  /// The parts of the words, for phrasings that put them otherwise: "time", "time2", "day".
  std::map<std::string, std::string> parts{};
};

std::string ago_words(int64_t seconds) {
  return fmt::format(" in the last {} seconds", seconds);
}

/// The spans that are asked about: all, days, and some at random.
std::vector<AskedSpan> asked_spans(const AnswerList& list, uint64_t seed) {
  const LivedPast& past = list.past;
  // Long before, so that the first action is not at its edge.
  const Time begin = past.recordings.front().first - std::chrono::hours(1);
  std::vector<AskedSpan> spans{{"all", "", begin, list.now}};
  const Time today = day_of(list.now);
  std::set<Time> days;
  for (const auto& [from, to] : past.recordings) days.insert(day_of(from));
  for (const Time day : days) {
    const Time end = std::min(day + std::chrono::days(1), list.now);
    if (day == today) spans.push_back({"{day}", " today", day, end, {{"day", "today"}}});
    if (day == today - std::chrono::days(1))
      spans.push_back({"{day}", " yesterday", day, end, {{"day", "yesterday"}}});
    if (days.size() > 1) spans.push_back({"{day}", " on " + day_words(day), day, end});
    const bool is_night = past.recordings.back().first < today + std::chrono::hours(5);
    if (day == today && !is_night && list.now < today + std::chrono::hours(12))
      spans.push_back({"{day}", " this morning", day, end});
  }
  if (!list.is_present()) return spans;
  std::mt19937_64 random(seed);
  const Time from = past.recordings.back().first;
  const auto length = static_cast<int64_t>(to_seconds(past.last_moment() - from));
  if (length < 10) return spans;
  const auto second = [&] {
    return std::chrono::ceil<std::chrono::seconds>(from) +
           std::chrono::seconds(2 +
                                static_cast<int64_t>(random() % static_cast<uint64_t>(length - 4)));
  };
  for (int i = 0; i < 6; ++i) {
    const Time at = second();
    spans.push_back(
        {"since_{time}", " since " + clock_words(at), at, list.now, {{"time", clock_words(at)}}});
    const Time other = second();
    const auto [low, high] = std::minmax(at, other);
    if (high - low > std::chrono::seconds(4))
      spans.push_back({"{time}..{time2}",
                       fmt::format(" between {} and {}", clock_words(low), clock_words(high)),
                       low,
                       high,
                       {{"time", clock_words(low)}, {"time2", clock_words(high)}}});
    const int64_t ago = 5 * (2 + static_cast<int64_t>(random() % 8));
    if (ago < length)
      spans.push_back({"last_s", ago_words(ago), list.now - std::chrono::seconds(ago), list.now});
    if (past.recordings.size() == 1)
      spans.push_back(
          {"before_{time}", " before " + clock_words(at), begin, at, {{"time", clock_words(at)}}});
  }
  return spans;
}

Actions begun_within(const Actions& actions, const AskedSpan& span) {
  Actions found;
  for (const LivedAction* action : actions)
    if (action->started >= span.from && action->started <= span.to) found.push_back(action);
  return found;
}

/// Whether none of the actions is at an edge of the span. The present is no edge.
bool are_clear(const Actions& actions, const AskedSpan& span, Time now) {
  const auto is_cut = [](const LivedAction& action, Time edge) {
    return action.started - kEdge < edge &&
           edge < action.ended.value_or(Time::max() - kEdge) + kEdge;
  };
  for (const LivedAction* action : actions)
    if (is_cut(*action, span.from) || (span.to != now && is_cut(*action, span.to))) return false;
  return true;
}

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
    KnownAnswer& often = add("how_often", "", count(all), all);
    KnownAnswer& whether = add("did_you", "", answers::YesNo{!all.empty()}, all);
    // That nothing is there shows nothing, so not to know is right as well.
    if (all.empty()) often.also = whether.also = {answers::Unknown{}};
  } else {
    add("how_often", "any", count(all), all);
    add("how_often", "success", count(done), done.empty() ? all : done);
    add("did_you", "any", answers::YesNo{true}, all);
    if (done.empty()) add("did_you", "success", answers::YesNo{false}, all);
  }
  if (span.when != "all" || all.size() != done.size() || all.empty()) return;
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
  if (all.size() > 1) {
    moment("first", *all.front());
    moment("last", *all.back());
  }
}

void add_neighbours(const AnswerList& list) {
  const Actions all = list.actions("any");
  for (size_t i = 0; i < all.size(); ++i) {
    const LivedAction& action = *all[i];
    if (action.outcome != "success" || list.actions(action.skill, action.thing).size() != 1)
      continue;
    if (action.skill != "pick" && action.skill != "place") continue;
    const auto is_near = [&](size_t other) {
      return std::abs(to_seconds(all[other]->started - action.started)) < 60;
    };
    if (i + 1 < all.size() && is_near(i + 1))
      list.add("events", {.what = "after_event", .skill = action.skill, .thing = action.thing},
               events_of({all[i + 1]}), {all[i + 1]->begun});
    if (i > 0 && is_near(i - 1))
      list.add("events", {.what = "before_event", .skill = action.skill, .thing = action.thing},
               events_of({all[i - 1]}), {all[i - 1]->begun});
  }
}

void add_ends(const AnswerList& list) {
  const Actions all = list.actions("any");
  if (all.empty()) return;
  list.add("events", {.what = "first_event", .skill = "any", .which = "first"},
           events_of({all.front()}), {all.front()->begun});
  KnownAnswer& last = list.add("events", {.what = "last_event", .skill = "any", .which = "last"},
                               events_of({all.back()}), {all.back()->begun});
  // What has not ended was not done yet, for some.
  if (!all.back()->ended && all.size() > 1) last.also = {events_of({all[all.size() - 2]})};
  for (const char* skill : {"pick", "place"}) {
    const Actions some = list.actions(skill);
    const Actions done = with_outcome(some, "success");
    if (done.empty() || done.back() != some.back()) continue;
    list.add("events", {.what = "which_thing", .skill = skill, .which = "last"},
             answers::Names{{done.back()->thing}}, {done.back()->begun, *done.back()->over});
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

/// What people asked for: commands that led to a plan.
void add_commands(const AnswerList& list) {
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
             answers::Reason{commands[at]->text, {commands[at]->id}},
             {commands[at]->id, plans[at]});
  };
  add("first", 0);
  add("last", commands.size() - 1);
  list.add("events", {.what = "how_many_commands"},
           answers::Count{static_cast<int64_t>(commands.size())}, {commands.front()->id});
  for (const std::string& thing : list.things()) {
    const LivedWords* words = nullptr;
    size_t count = 0;
    for (const LivedWords* one : commands)
      if (one->text.find(thing) != std::string::npos) {
        words = one;
        ++count;
      }
    if (count != 1) continue;
    list.add("events", {.what = "who_asked", .thing = thing}, answers::Names{{words->speaker}},
             {words->id});
    list.add("events", {.what = "when_asked", .thing = thing}, answers::Moment{words->time},
             {words->id});
  }
}

}  // namespace

void add_event_answers(const AnswerList& list, uint64_t seed) {
  for (const AskedSpan& span : asked_spans(list, seed)) {
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
  add_ends(list);
  add_things_done(list);
  add_commands(list);
}

}  // namespace engram::speech::dialogues
