// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "speech/facts/answer_value.h"

namespace engram::speech {

/// A question with its true answer.
struct Dialogue {
  std::string id;      ///< Unique among those that were made together.
  std::string family;  ///< "objects", "events", "explanations", ...
  /// What is asked, apart from its words: "how_often:success".
  std::string form;
  std::string question;
  std::string phrasing;  ///< Names the template, and the words for a skill: "how_often#2/pick*.1".
  int64_t seed = 0;      ///< Of the first recording that is asked about.
  Time now{};            ///< When it is asked.
  AnswerValue value{};   ///< Unknown: it cannot be answered.
  /// Other values that are as right.
  std::vector<AnswerValue> also{};
  /// An answer must show at least one of these. Empty: nothing shows that nothing happened.
  std::vector<ltm::MemoryId> evidence{};
  /// What training must not have seen of it: "phrasing", "seed", "thing". Sorted.
  std::vector<std::string> held_out{};
  /// The same question in a few of the generator's own words, for whoever learns what others mean;
  /// empty unless DialogueOptions::tells_plainly. It is no part of the JSON.
  std::vector<std::string> plain{};
};

/// One line of JSON without its end: {"id", "family", "form", "question", "phrasing", "seed",
/// "now", "value", "also", "evidence", "answerable", "held_out"}.
[[nodiscard]] std::string to_json_line(const Dialogue& dialogue);

/// Whether a seed, the name of a thing, or a phrasing is kept for trials; one in five is. The same
/// always, on every machine.
[[nodiscard]] bool is_seed_held_out(int64_t seed);
[[nodiscard]] bool is_thing_held_out(const std::string& spoken_name);
[[nodiscard]] bool is_phrasing_held_out(const std::string& phrasing);

}  // namespace engram::speech
