// SPDX-License-Identifier: Apache-2.0
#include "speech/language/word_pattern.h"

#include <algorithm>

namespace engram::speech {

std::vector<std::string_view> parts_between(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  while (!text.empty()) {
    const size_t end = std::min(text.find(separator), text.size());
    if (end > 0) parts.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return parts;
}

WordPattern::WordPattern(std::string_view text) {
  for (std::string_view word : parts_between(text, ' ')) {
    Part part;
    part.is_optional = word.ends_with('?');
    if (part.is_optional) word.remove_suffix(1);
    part.alternatives = parts_between(word, '|');
    parts_.push_back(std::move(part));
  }
}

size_t WordPattern::count_from(size_t part, const std::vector<QuestionWord>& words,
                               size_t at) const {
  if (part == parts_.size()) return 0;
  const Part& here = parts_[part];
  if (at < words.size() && std::find(here.alternatives.begin(), here.alternatives.end(),
                                     words[at].text) != here.alternatives.end())
    if (const size_t rest = count_from(part + 1, words, at + 1); rest != kNone) return rest + 1;
  return here.is_optional ? count_from(part + 1, words, at) : kNone;
}

size_t WordPattern::count_at(const std::vector<QuestionWord>& words, size_t at) const {
  const size_t count = count_from(0, words, at);
  return count == kNone ? 0 : count;
}

size_t WordPatterns::count_at(const std::vector<QuestionWord>& words, size_t at) const {
  size_t longest = 0;
  for (const WordPattern& pattern : patterns_)
    longest = std::max(longest, pattern.count_at(words, at));
  return longest;
}

void erase_words(std::vector<QuestionWord>& words, size_t at, size_t count) {
  const bool begins = words[at].begins_sentence;
  const bool ends = std::any_of(words.begin() + static_cast<ptrdiff_t>(at),
                                words.begin() + static_cast<ptrdiff_t>(at + count),
                                [](const QuestionWord& word) { return word.ends_clause; });
  words.erase(words.begin() + static_cast<ptrdiff_t>(at),
              words.begin() + static_cast<ptrdiff_t>(at + count));
  if (at < words.size() && begins) words[at].begins_sentence = true;
  if (at > 0 && ends) words[at - 1].ends_clause = true;
}

}  // namespace engram::speech
