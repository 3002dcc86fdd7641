// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the spans of time that are asked about.

#include <map>
#include <string>
#include <vector>

#include "speech/dialogues/known_answer.h"

namespace engram::speech::dialogues {

/// A span of time, and how people put it.
struct AskedSpan {
  std::string when;   ///< As Asked::when.
  std::string words;  ///< " yesterday"; empty: always.
  Time from{};
  Time to{};
  /// The parts of the words, for phrasings that put them otherwise: "time", "time2", "day".
  std::map<std::string, std::string> parts{};
};

/// All of the past, days, and some spans at random of the last recording.
[[nodiscard]] std::vector<AskedSpan> asked_spans(const AnswerList& list, uint64_t seed);

[[nodiscard]] Actions begun_within(const Actions& actions, const AskedSpan& span);

/// Whether none of the actions is at an edge of the span. The present is no edge.
[[nodiscard]] bool are_clear(const Actions& actions, const AskedSpan& span, Time now);

}  // namespace engram::speech::dialogues
