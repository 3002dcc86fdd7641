// SPDX-License-Identifier: Apache-2.0
#include "speech/language/question_phrases.h"

#include "speech/language/word_pattern.h"

namespace engram::speech {

namespace {

struct ReadPhrase {
  const Phrase* from;
  WordPattern words;
  std::vector<std::string_view> by;
};

const std::vector<ReadPhrase>& all_phrases() {
  static const std::vector<ReadPhrase> kAll = [] {
    std::vector<ReadPhrase> all;
    for (const auto table : {phrases_of_asking(), phrases_of_deeds(), phrases_of_things()})
      for (const Phrase& phrase : table)
        all.push_back({&phrase, WordPattern(phrase.words), parts_between(phrase.by, ' ')});
    return all;
  }();
  return kAll;
}

bool is_what_you(const ReadPhrase& phrase) {
  return phrase.by.size() == 2 && phrase.by[0] == "what" && phrase.by[1] == "you";
}

struct FoundPhrase {
  const ReadPhrase* phrase = nullptr;  ///< Null: none begins there.
  size_t count = 0;                    ///< Of the words that it replaces.
};

/// Of phrases with equally many words the first one counts.
FoundPhrase longest_at(const std::vector<QuestionWord>& words, size_t at) {
  FoundPhrase longest;
  for (const ReadPhrase& phrase : all_phrases()) {
    // "Everything you did" is what you did, but "was everything you did right" is not.
    if (is_what_you(phrase) && !words[at].begins_sentence) continue;
    if (const size_t count = phrase.words.count_at(words, at); count > longest.count)
      longest = {&phrase, count};
  }
  return longest;
}

}  // namespace

const Phrase* phrase_at(const std::vector<QuestionWord>& words, size_t at) {
  const ReadPhrase* longest = longest_at(words, at).phrase;
  return longest == nullptr ? nullptr : longest->from;
}

void replace_phrases(std::vector<QuestionWord>& words) {
  for (size_t at = 0; at < words.size();) {
    const auto [longest, count] = longest_at(words, at);
    if (longest == nullptr) {
      ++at;
      continue;
    }
    if (longest->by.empty()) {
      // Another phrase may begin at the word that follows.
      erase_words(words, at, count);
      continue;
    }
    const QuestionWord first = words[at];
    const bool ends = words[at + count - 1].ends_clause;
    words.erase(words.begin() + static_cast<ptrdiff_t>(at),
                words.begin() + static_cast<ptrdiff_t>(at + count));
    for (size_t i = 0; i < longest->by.size(); ++i)
      words.insert(
          words.begin() + static_cast<ptrdiff_t>(at + i),
          QuestionWord{std::string(longest->by[i]), first.given, i == 0 && first.begins_sentence,
                       false, ends && i + 1 == longest->by.size()});
    // What was put there is not looked at again, so that this ends.
    at += longest->by.size();
  }
}

}  // namespace engram::speech
