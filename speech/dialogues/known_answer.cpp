// SPDX-License-Identifier: Apache-2.0
#include "speech/dialogues/known_answer.h"

#include <array>

namespace engram::speech::dialogues {

Asked asked_of(Asked base, const char* what) {
  base.what = what;
  return base;
}

KnownAnswer& AnswerList::add(const char* family, Asked asked, AnswerValue value,
                             std::vector<ltm::MemoryId> evidence) const {
  KnownAnswer& added = known.emplace_back();
  added.family = family;
  added.asked = std::move(asked);
  added.now = now;
  added.value = std::move(value);
  added.evidence = std::move(evidence);
  return added;
}

void AnswerList::add_unknown(const char* why, Asked asked,
                             std::map<std::string, std::string> slots) const {
  asked.what = "unanswerable:" + std::string(why);
  add("unanswerable", std::move(asked), answers::Unknown{}, {}).slots = std::move(slots);
}

bool AnswerList::is_present() const {
  return now - past.last_moment() < std::chrono::milliseconds(500);
}

std::vector<std::string> AnswerList::things() const {
  std::vector<std::string> names;
  for (const auto& [name, sights] : past.sights) names.push_back(name);
  return names;
}

Actions AnswerList::actions(const std::string& skill, const std::string& thing,
                            const std::string& place) const {
  Actions found;
  for (const LivedAction& action : past.actions)
    if ((skill == "any" || action.skill == skill) && (thing.empty() || action.thing == thing) &&
        (place.empty() || action.place == place))
      found.push_back(&action);
  return found;
}

std::vector<ltm::MemoryId> begun_ids(const Actions& actions) {
  std::vector<ltm::MemoryId> ids;
  for (const LivedAction* action : actions) ids.push_back(action->begun);
  return ids;
}

std::vector<ltm::MemoryId> over_ids(const Actions& actions) {
  std::vector<ltm::MemoryId> ids;
  for (const LivedAction* action : actions)
    if (action->over) ids.push_back(*action->over);
  return ids;
}

std::vector<ltm::MemoryId> all_ids(const Actions& actions) {
  std::vector<ltm::MemoryId> ids = begun_ids(actions);
  for (ltm::MemoryId& id : over_ids(actions)) ids.push_back(std::move(id));
  return ids;
}

AnswerValue events_of(const Actions& actions) {
  return answers::Events{begun_ids(actions)};
}

Actions with_outcome(const Actions& actions, const std::string& outcome) {
  Actions found;
  for (const LivedAction* action : actions)
    if (action->outcome == outcome) found.push_back(action);
  return found;
}

bool are_all_done(const Actions& actions) {
  return with_outcome(actions, "success").size() == actions.size();
}

Time day_of(Time time) {
  return std::chrono::floor<std::chrono::days>(time);
}

std::string clock_words(Time time) {
  const std::chrono::hh_mm_ss clock(std::chrono::floor<std::chrono::seconds>(time - day_of(time)));
  return fmt::format("{}:{:02}:{:02}", clock.hours().count(), clock.minutes().count(),
                     clock.seconds().count());
}

std::string day_words(Time time) {
  constexpr std::array kMonths{"January",   "February", "March",    "April",
                               "May",       "June",     "July",     "August",
                               "September", "October",  "November", "December"};
  const std::chrono::year_month_day day{std::chrono::floor<std::chrono::days>(time)};
  return fmt::format("{} {}", kMonths.at(static_cast<unsigned>(day.month()) - 1),
                     static_cast<unsigned>(day.day()));
}

std::deque<KnownAnswer> known_answers(const LivedPast& past, Time now, uint64_t seed) {
  std::deque<KnownAnswer> known;
  const AnswerList list{past, now, known};
  add_object_answers(list);
  add_event_answers(list, seed);
  add_task_answers(list);
  add_reason_answers(list);
  add_detail_answers(list);
  add_moment_answers(list, seed);
  add_problem_answers(list);
  add_unknown_answers(list, seed);
  add_instead_answers(list);
  return known;
}

}  // namespace engram::speech::dialogues
