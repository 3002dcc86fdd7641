// SPDX-License-Identifier: Apache-2.0
#include "speech/dialogues/asked_spans.h"

#include <algorithm>
#include <random>
#include <set>

namespace engram::speech::dialogues {

namespace {

/// An action so near to the edge of a span of time may be meant or not.
constexpr Duration kEdge = std::chrono::milliseconds(600);

std::string ago_words(int64_t seconds) {
  return fmt::format(" in the last {} seconds", seconds);
}

}  // namespace

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

bool are_clear(const Actions& actions, const AskedSpan& span, Time now) {
  const auto is_cut = [](const LivedAction& action, Time edge) {
    return action.started - kEdge < edge &&
           edge < action.ended.value_or(Time::max() - kEdge) + kEdge;
  };
  for (const LivedAction* action : actions)
    if (is_cut(*action, span.from) || (span.to != now && is_cut(*action, span.to))) return false;
  return true;
}

}  // namespace engram::speech::dialogues
