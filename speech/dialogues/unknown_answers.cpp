// SPDX-License-Identifier: Apache-2.0
// What nobody can answer.
#include <algorithm>
#include <array>
#include <random>

#include "speech/dialogues/known_answer.h"
#include "speech/dialogues/random_choice.h"

namespace engram::speech::dialogues {

namespace {

/// Things and persons that no kitchen here has.
constexpr std::array kStrangeThings{
    "spoon",      "newspaper", "red cup",    "banana",  "scissors",   "television",
    "umbrella",   "cheese",    "toothbrush", "violin",  "laptop",     "cactus",
    "frying pan", "bread",     "keys",       "wallet",  "teddy bear", "honey",
    "remote",     "hammer",    "green bowl", "water",   "yoghurt",    "phone",
    "candle",     "pineapple", "broom",      "vinegar", "dog",        "sugar"};
constexpr std::array kStrangePersons{"Peter", "Maria", "Grandma", "Mister Smith", "Chen", "Olga"};
constexpr std::array kStrangePlaces{"balcony", "cellar",   "bathroom", "fridge",
                                    "garage",  "bookcase", "roof",     "garden"};

bool is_known(const LivedPast& past, const std::string& thing) {
  return std::any_of(
      past.known_things.begin(), past.known_things.end(), [&](const std::string& one) {
        return one.find(thing) != std::string::npos || thing.find(one) != std::string::npos;
      });
}

void add_strangers(const AnswerList& list, std::mt19937_64& random) {
  for (int i = 0; i < 8; ++i)
    if (const std::string thing = *one_of(kStrangeThings, random); !is_known(list.past, thing))
      list.add_unknown("unknown_thing", {.thing = thing});
  for (int i = 0; i < 2; ++i) {
    list.add_unknown("unknown_person", {}, {{"person", *one_of(kStrangePersons, random)}});
    if (const std::string place = *one_of(kStrangePlaces, random);
        !list.past.places.contains(place))
      list.add_unknown("unknown_place", {.place = place});
  }
}

/// What presupposes something that did not happen.
void add_presuppositions(const AnswerList& list) {
  for (const std::string& thing : list.past.known_things) {
    const bool is_seen = list.past.sights.contains(thing);
    if (!is_seen) list.add_unknown("never_seen", {.thing = thing});
    if (list.actions("pick", thing).empty())
      list.add_unknown("never_done", {.skill = "pick", .thing = thing});
    if (list.actions("place", thing).empty()) {
      list.add_unknown("never_done", {.skill = "place", .thing = thing});
      continue;
    }
    // It was put down, but somewhere else.
    for (const auto& [place, pose] : list.past.places)
      if (list.actions("place", thing, place).empty())
        list.add_unknown("never_done", {.skill = "place", .thing = thing, .place = place});
  }
  for (const auto& [place, pose] : list.past.places)
    if (list.actions("navigate", "", place).empty())
      list.add_unknown("never_done", {.skill = "navigate", .place = place});
}

void add_strange_times(const AnswerList& list, std::mt19937_64& random) {
  const Time begin = list.past.recordings.front().first;
  if (begin - day_of(begin) > std::chrono::hours(2) && day_of(begin) == day_of(list.now)) {
    const auto earlier = static_cast<uint64_t>(to_seconds(begin - day_of(begin))) - 3600;
    list.add_unknown(
        "unknown_time", {.when = "{time}"},
        {{"at", "at " + clock_words(day_of(begin) + std::chrono::seconds(random() % earlier))}});
  }
  const auto has_day = [&](Time day) {
    return std::any_of(list.past.recordings.begin(), list.past.recordings.end(),
                       [&](const auto& one) { return day_of(one.first) == day; });
  };
  const Time yesterday = day_of(list.now) - std::chrono::days(1);
  if (!has_day(yesterday))
    list.add_unknown("unknown_day", {.when = "{day}"}, {{"when", " yesterday"}});
  const Time week = day_of(list.now) - std::chrono::days(7);
  if (!has_day(week))
    list.add_unknown("unknown_day", {.when = "{day}"}, {{"when", " on " + day_words(week)}});
}

}  // namespace

void add_unknown_answers(const AnswerList& list, uint64_t seed) {
  std::mt19937_64 random(seed + 2);
  add_strangers(list, random);
  add_presuppositions(list);
  add_strange_times(list, random);
  for (int i = 0; i < 4; ++i) {
    list.add_unknown("no_question", {});
    list.add_unknown("not_of_memory", {});
    list.add_unknown("future", {});
  }
}

}  // namespace engram::speech::dialogues
