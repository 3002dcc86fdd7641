// SPDX-License-Identifier: Apache-2.0
#include "speech/noticing/task_words.h"

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "ltm/core/ascii.h"
#include "speech/program/skill_verbs.h"

namespace engram::speech {

namespace {

constexpr size_t kMaxText = 500;
constexpr size_t kMaxName = 60;

constexpr std::array<std::string_view, 9> kArticles{"the",  "a",    "an", "your", "this",
                                                    "that", "some", "my", "its"};
constexpr std::array<std::string_view, 16> kPrepositions{
    "on", "onto", "in",   "into", "inside", "from", "off",  "to",
    "at", "near", "next", "by",   "under",  "of",   "with", "beside"};
/// "With your right hand", "a bottle of water": no place.
constexpr std::array<std::string_view, 3> kOfOther{"with", "of", "by"};
/// Of a verb, behind it: "pick up", "put down".
constexpr std::array<std::string_view, 6> kParticles{"up", "down", "out", "away", "over", "back"};
constexpr std::array<std::string_view, 5> kPolite{"please", "now", "then", "first", "robot"};

template <size_t Count>
bool is_one_of(std::string_view word, const std::array<std::string_view, Count>& words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

/// The words of the first sentence or part, without marks.
std::vector<std::string> words_of_first_part(std::string_view text) {
  std::vector<std::string> words(1);
  for (const char letter : text.substr(0, kMaxText)) {
    const bool is_of_word = std::isalnum(static_cast<unsigned char>(letter)) != 0 ||
                            letter == '-' || letter == '\'' || (letter & 0x80) != 0;
    if (is_of_word) {
      words.back() += letter;
      continue;
    }
    if (!words.back().empty()) words.emplace_back();
    const bool is_end = std::string_view(".!?;,:\n").find(letter) != std::string_view::npos;
    if (is_end && words.size() > 1) break;
  }
  if (words.back().empty()) words.pop_back();
  for (std::string& word : words) word = lower_ascii(word);
  // What comes after "and" is another deed.
  words.erase(std::find_if(words.begin(), words.end(),
                           [](const std::string& word) { return word == "and" || word == "then"; }),
              words.end());
  return words;
}

std::string known_skill(const std::string& verb) {
  for (const SkillVerb& known : skill_verbs())
    if (has_lemma(known, verb)) return std::string(known.lemmas.substr(0, known.lemmas.find(' ')));
  return verb;
}

/// Takes the words of a name from `at` on, without its article.
std::string take_name(const std::vector<std::string>& words, size_t& at) {
  while (at < words.size() && is_one_of(words[at], kArticles)) ++at;
  std::string name;
  for (; at < words.size() && !is_one_of(words[at], kPrepositions); ++at) {
    if (is_one_of(words[at], kParticles) || is_one_of(words[at], kArticles)) continue;
    if (name.size() + words[at].size() >= kMaxName) continue;
    name += (name.empty() ? "" : " ") + words[at];
  }
  return name;
}

}  // namespace

TaskWords task_words(std::string_view text) {
  const std::vector<std::string> words = words_of_first_part(text);
  TaskWords task;
  size_t at = 0;
  while (at < words.size() && is_one_of(words[at], kPolite)) ++at;
  if (at == words.size()) return task;
  task.skill = known_skill(words[at++]);
  task.thing = take_name(words, at);
  while (at < words.size() && task.place.empty()) {
    const bool is_of_place = !is_one_of(words[at], kOfOther);
    // "next to the sink", "out of the box".
    while (at < words.size() && is_one_of(words[at], kPrepositions)) ++at;
    const std::string name = take_name(words, at);
    if (is_of_place) task.place = name;
  }
  return task;
}

std::string head_word(const std::string& thing) {
  const size_t space = thing.rfind(' ');
  return space == std::string::npos ? thing : thing.substr(space + 1);
}

std::string entity_name(const std::string& words) {
  std::string name;
  for (const char letter : words)
    name += std::isalnum(static_cast<unsigned char>(letter)) != 0 ? letter : '_';
  return name;
}

}  // namespace engram::speech
