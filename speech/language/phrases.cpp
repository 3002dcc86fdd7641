// SPDX-License-Identifier: Apache-2.0
#include "speech/language/question_phrases.h"

#include <algorithm>

#include <algorithm>

#include "speech/language/word_pattern.h"

namespace engram::speech {

namespace {

struct ReadPhrase {
  WordPattern words;
  std::vector<std::string_view> by;
};

const std::vector<ReadPhrase>& all_phrases() {
  static const std::vector<ReadPhrase> kAll = [] {
    std::vector<ReadPhrase> all;
    for (const auto table : {phrases_of_asking(), phrases_of_deeds(), phrases_of_things()})
      for (const Phrase& phrase : table)
        all.push_back({WordPattern(phrase.words), parts_between(phrase.by, ' ')});
    return all;
  }();
  return kAll;
}

bool is_what_you(const ReadPhrase& phrase) {
  return phrase.by.size() == 2 && phrase.by[0] == "what" && phrase.by[1] == "you";
}

}  // namespace

void replace_phrases(std::vector<QuestionWord>& words) {
  for (size_t at = 0; at < words.size(); ++at) {
    const ReadPhrase* longest = nullptr;
    size_t count = 0;
    for (const ReadPhrase& phrase : all_phrases()) {
      // "Everything you did" is what you did, but "was everything you did right" is not.
      if (is_what_you(phrase) && !words[at].begins_sentence) continue;
      if (const size_t here = phrase.words.count_at(words, at); here > count) {
        count = here;
        longest = &phrase;
      }
    }
    if (longest == nullptr) continue;
    const QuestionWord first = words[at];
    const bool ends = words[at + count - 1].ends_clause;
    if (longest->by.empty() && ends && at > 0) words[at - 1].ends_clause = true;
    words.erase(words.begin() + static_cast<ptrdiff_t>(at),
                words.begin() + static_cast<ptrdiff_t>(at + count));
    for (size_t i = 0; i < longest->by.size(); ++i)
      words.insert(
          words.begin() + static_cast<ptrdiff_t>(at + i),
          QuestionWord{std::string(longest->by[i]), first.given, i == 0 && first.begins_sentence,
                       false, ends && i + 1 == longest->by.size()});
    // What was put there is not looked at again, so that this ends.
    at += std::max<size_t>(longest->by.size(), 1) - 1;
  }
}

}  // namespace engram::speech
