// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "speech/language/english.h"

namespace engram::speech {

namespace {

/// Roundabout beginnings. What ends with '?' makes a question of what follows.
constexpr std::string_view kPoliteBeginnings[] = {"would you be so kind as to tell me",
                                                  "could you be so kind as to tell me",
                                                  "be so kind as to tell me",
                                                  "would you be so kind and tell me",
                                                  "please give me",
                                                  "could you give me",
                                                  "can you give me",
                                                  "give me",
                                                  "can you confirm that",
                                                  "could you confirm that",
                                                  "can you confirm",
                                                  "is it true that",
                                                  "is it right that",
                                                  "is it correct that",
                                                  "is it the case that",
                                                  "am i right that",
                                                  "can you show me",
                                                  "can you let me know",
                                                  "could you let me know",
                                                  "do you have any idea",
                                                  "have you any idea",
                                                  "would you know",
                                                  "would you say",
                                                  "could you please tell me",
                                                  "can you please tell me",
                                                  "would you please tell me",
                                                  "could you kindly tell me",
                                                  "could you tell me please",
                                                  "can you tell me please",
                                                  "would you mind telling me",
                                                  "do you happen to know",
                                                  "do you happen to remember",
                                                  "could you tell me",
                                                  "can you tell me",
                                                  "would you tell me",
                                                  "will you tell me",
                                                  "could you tell us",
                                                  "can you tell us",
                                                  "could you say",
                                                  "can you say",
                                                  "can you explain",
                                                  "could you explain",
                                                  "can you remember",
                                                  "could you remember",
                                                  "can you recall",
                                                  "could you recall",
                                                  "can you remind me",
                                                  "could you remind me",
                                                  "please remind me",
                                                  "remind me",
                                                  "do you remember",
                                                  "do you recall",
                                                  "do you know",
                                                  "do you still know",
                                                  "do you still remember",
                                                  "i would like to know",
                                                  "i did like to know",
                                                  "i want to know",
                                                  "i wanted to know",
                                                  "i need to know",
                                                  "i should like to know",
                                                  "i wonder",
                                                  "i am wondering",
                                                  "i was wondering",
                                                  "i am curious",
                                                  "i am interested in",
                                                  "please tell me",
                                                  "pls tell me",
                                                  "tell me please",
                                                  "please let me know",
                                                  "let me know",
                                                  "please say",
                                                  "please explain",
                                                  "explain to me",
                                                  "explain",
                                                  "tell me again",
                                                  "tell me",
                                                  "tell us",
                                                  "show me",
                                                  "any idea",
                                                  "any clue",
                                                  "have you a clue",
                                                  "do you have a clue",
                                                  "have you any clue",
                                                  "no idea",
                                                  "say",
                                                  "may i ask",
                                                  "can i ask"};

/// What somebody does not know is asked for where a question word follows: "I forgot who".
constexpr std::string_view kIgnorantBeginnings[] = {
    "i can not remember", "i do not remember", "i can not recall", "i do not recall",
    "i do not know",      "i forgot",          "i have forgotten", "i did not see",
    "i did not notice",   "i did not catch",   "i am not sure",    "i have no idea",
};

bool is_question_word(std::string_view word) {
  return word == "who" || word == "whom" || word == "what" || word == "which" || word == "where" ||
         word == "when" || word == "why" || word == "how" || word == "whether" || word == "if";
}

}  // namespace

bool take_politeness(std::vector<QuestionWord>& words) {
  bool is_taken = false;
  // Several may follow each other: "Hello robot, do you remember, could you tell me ...".
  for (size_t at = 0; at < std::min<size_t>(words.size(), 12);) {
    bool is_here = false;
    // Only what nothing but a greeting precedes is a beginning.
    if (at > 0 && !is_filler(words[at - 1].text)) break;
    for (const std::string_view beginning : kPoliteBeginnings) {
      const auto phrase = parts_of_phrase(beginning);
      if (!is_phrase_at(words, at, phrase) || words.size() == at + phrase.size()) continue;
      words.erase(words.begin() + static_cast<ptrdiff_t>(at),
                  words.begin() + static_cast<ptrdiff_t>(at + phrase.size()));
      if (at < words.size()) words[at].begins_sentence = true;
      is_here = is_taken = true;
      break;
    }
    for (const std::string_view beginning : kIgnorantBeginnings) {
      const auto phrase = parts_of_phrase(beginning);
      const size_t next = at + phrase.size();
      if (is_here || !is_phrase_at(words, at, phrase) || next >= words.size() ||
          !is_question_word(words[next].text))
        continue;
      words.erase(words.begin() + static_cast<ptrdiff_t>(at),
                  words.begin() + static_cast<ptrdiff_t>(next));
      words[at].begins_sentence = true;
      is_here = is_taken = true;
    }
    if (!is_here) ++at;
  }
  return is_taken;
}

}  // namespace engram::speech
