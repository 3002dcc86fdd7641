// SPDX-License-Identifier: Apache-2.0
#include "speech/dialogues/asking_times.h"

#include <algorithm>
#include <random>

namespace engram::speech::dialogues {

namespace {

/// There must be something to ask about.
constexpr Duration kAfterBegin = std::chrono::seconds(6);
constexpr Duration kStep = std::chrono::milliseconds(100);

bool is_near(Time time, Time now) {
  return now - kUnclear < time && time < now + kUnclear;
}

bool is_quiet(const LivedPast& past, Time now) {
  const auto is_near_action = [now](const LivedAction& one) {
    return is_near(one.started, now) || (one.ended && is_near(*one.ended, now));
  };
  return std::none_of(past.actions.begin(), past.actions.end(), is_near_action) &&
         std::none_of(past.words.begin(), past.words.end(),
                      [now](const LivedWords& one) { return is_near(one.time, now); });
}

/// Nothing: a hand took or let go of something then.
std::optional<bool> is_holding(const LivedPast& past, Time now) {
  bool is_any_held = false;
  for (const auto& [thing, sights] : past.sights) {
    const LivedSight* at = past.sight_at(thing, now);
    if (at == nullptr) continue;
    for (const Time beside : {now - kUnclear, now + kUnclear}) {
      const LivedSight* other = past.sight_at(thing, beside);
      if (other == nullptr || other->held_by != at->held_by) return {};
    }
    is_any_held = is_any_held || !at->held_by.empty();
  }
  return is_any_held;
}

}  // namespace

std::vector<Time> asking_times(const LivedPast& past, uint64_t seed) {
  const auto& [from, to] = past.recordings.back();
  std::vector<Time> all;
  std::vector<Time> holding;
  for (Time now = from + kAfterBegin; now + kUnclear < to; now += kStep) {
    if (!is_quiet(past, now)) continue;
    const auto is_held = is_holding(past, now);
    if (!is_held) continue;
    all.push_back(now);
    if (*is_held) holding.push_back(now);
  }
  std::mt19937_64 random(seed + 3);
  std::vector<Time> chosen;
  for (const std::vector<Time>* some : {&holding, &all})
    if (!some->empty()) chosen.push_back((*some)[random() % some->size()]);
  return chosen;
}

}  // namespace engram::speech::dialogues
