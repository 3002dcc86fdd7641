// SPDX-License-Identifier: Apache-2.0
// What makes a question of a statement, and how people call whom they talk to.
#include "speech/language/english.h"
#include "speech/language/word_pattern.h"

namespace engram::speech {

namespace {

/// What stands behind a statement, or before it, and asks whether it is so.
constexpr std::string_view kTags[] = {
    "is|was|are|were|did|do|does|has|have|had|can|could|will|would not? "
    "it|you|they|he|she|there|that|this|i|we",
    "right|correct|true|yes|no|eh|huh|ok|okay|innit|really",
    "am i right|correct|wrong|mistaken?",
    "is|was that|this|it so|right|correct|true|really",
    "is that the case",
    "true or false",
    "yes or no",
    "or not|no",
    "or did|have|were|are|is|was you|it not?",
    "please confirm",
    "i think|guess|suppose|believe|hope|know|bet",
};

constexpr std::string_view kEndearments[] = {
    "my|you|old|little? dear|dearest|darling|sweetheart|sweetie|honeybun|love|lovely|treasure|pet "
    "one?",
    "my|good|dear|old|nice|little|clever|brave my|good|dear|old|nice|little|clever|brave? "
    "robot|boy|girl|fellow|friend|man|lad|chap|machine|mate|one|thing",
    "poor|silly thing|you|dear|fellow",
    "sweetheart|sweetie|darling|pal|buddy|mate|bless you?",
    "for heaven|goodness|god|pity sake",
    "goodness|heavens|gosh|blimey|pray|prithee|alas|ugh|wow|hmm gracious|me?",
    "oh|well dear|boy|my|well|no",
    "if you please|like",
    "bless you",
    "be honest",
    "never mind",
    "by any chance",
    "pretty? please",
};

/// Puts "whether" before the last sentence unless it asks already. Whoever says no verb means that
/// something is so: "coffee in the gripper".
void ask_whether(std::vector<QuestionWord>& words) {
  size_t begin = words.size() - 1;
  while (begin > 0 && !words[begin].begins_sentence) --begin;
  for (size_t at = begin; at < words.size(); ++at)
    if (is_question_word(words[at].text) && (at == begin || words[at - 1].ends_clause)) return;
  if (is_auxiliary(words[begin].text) || words[begin].text == "whether") return;
  put_whether(words, begin);
}

}  // namespace

void put_whether(std::vector<QuestionWord>& words, size_t at) {
  words.insert(words.begin() + static_cast<ptrdiff_t>(at),
               QuestionWord{.text = "whether", .given = "whether", .begins_sentence = true});
  words[at + 1].begins_sentence = false;
}

void take_question_tags(std::vector<QuestionWord>& words) {
  static const WordPatterns kPatterns(kTags);
  bool is_asked = false;
  for (size_t at = 1; at < words.size();) {
    const bool begins = words[at].begins_sentence || words[at - 1].ends_clause ||
                        words[at].text == "or" || words[at].text == "yes";
    size_t count = begins ? kPatterns.count_at(words, at) : 0;
    if (count > 0 && !words[at + count - 1].ends_clause) count = 0;
    const bool is_denied = count == 3 && words[at + 1].text == "not";
    const bool is_last = at + count == words.size() ||
                         (count > 0 && (is_denied || words[at + count].begins_sentence));
    if (count == 0 || !is_last) {
      ++at;
      continue;
    }
    // "It worked, didn't it, in the end": it may stand amid them.
    // "Did it?" behind a statement asks it; behind a question it says nothing.
    is_asked = at + count == words.size() || !words[at + count].begins_sentence;
    erase_words(words, at, count);
  }
  if (is_asked) ask_whether(words);
}

void take_endearments(std::vector<QuestionWord>& words) {
  static const WordPatterns kPatterns(kEndearments);
  for (size_t at = 0; at < words.size();) {
    // They stand between marks: "my dear" is nobody in "where is my dear mug".
    const bool begins = at == 0 || words[at].begins_sentence || words[at - 1].ends_clause;
    const size_t count = begins ? kPatterns.count_at(words, at) : 0;
    if (count == 0 || !words[at + count - 1].ends_clause || count == words.size())
      ++at;
    else
      erase_words(words, at, count);
  }
}

}  // namespace engram::speech
