// SPDX-License-Identifier: Apache-2.0
// Polite and roundabout beginnings of questions.
#include "speech/language/english.h"
#include "speech/language/word_pattern.h"

namespace engram::speech {

namespace {

/// Roundabout beginnings.
constexpr std::string_view kBeginnings[] = {
    "please|kindly|just? tell|show|remind|inform|give me|us please|again|once|quickly|of?",
    "please|kindly? can|could|would|will|might you "
    "please|kindly|perhaps|possibly|maybe|just|still? "
    "tell|show|remind|inform|give me|us please|again|once|of?",
    "can|could|would|will you please|kindly|perhaps|possibly|just|still|ever? "
    "say|state|report|explain|remember|recall|think|know please|kindly?",
    "would|could you be so kind|good as|and to? tell me|us",
    "would|could you be kind|good enough to tell|explain me|us? to? me|us?",
    "would|do you mind telling|showing|explaining me|us? to? me|us?",
    "be so kind|good as|and to? tell me|us",
    "if you do not mind",
    "if i may ask",
    "if you please",
    "can|could|will|would you please? let me|us know",
    "please|just|so? let me|us know|have|see|hear",
    "do|can|would|might you happen to? know|remember|recall|say",
    "do|would|can you still|even|perhaps? know|recall|say|remember",
    "have|has you any|some|an|a idea|clue|notion",
    "do you have any|some|an|a idea|clue|notion",
    "any|some idea|clue|notion of|about?",
    "no idea",
    "got any|an|a idea|clue",
    "i would|did|should|will really|also|just|so|very|now|only? much? "
    "like|love|want|care|wish|need|be|prefer glad|interested|happy|curious|pleased? "
    "to|in please|also|just? know|hear|learn|see|have|understand|find|get|ask|knowing|hearing|"
    "learning out|about|from|of? you?",
    "i want|wanted|need|wish|long to please|also|just? know|hear|learn|see|understand|find|ask "
    "out|about|from|of? you?",
    "i would|did like|love|need",
    "i need",
    "i am also|really|just|rather|very? curious|interested|wondering|asking|after to|in|about? "
    "know|hear|learn|knowing|hearing|learning?",
    "i was just? wondering|curious|asking about?",
    "i wonder|ask",
    "i ask|am|was asking? myself",
    "my question is",
    "the question is",
    "what i need|want|would|wish|did like? to know|hear|learn is",
    "please|pls|kindly|do say|state|report|indicate|remember|recall|return|print",
    "say|state|indicate|recall|return",
    "please|kindly? specify|provide|determine|identify|compute|calculate|clarify|disclose me|us?",
    "get|look|check me|us? up",
    "may|might|can|could i|we ask|know|hear|learn please?",
    "i hear|heard that",
    "for|in my|the record|records|log|information|protocol",
};

/// What somebody does not know, or wants to be explained, is asked for where a question word
/// follows: "I forgot who", "explain why".
constexpr std::string_view kBeforeQuestionWords[] = {
    "i can|could|do|did|shall not|never|hardly? quite|really|even|exactly|fully? "
    "remember|recall|know|see|notice|catch|hear|understand|get|tell|say|think|find",
    "i seem to? have? forgotten",
    "i have? forgot|forget|forgotten",
    "i have no|not idea|clue|notion",
    "i am|was not|un quite? sure|certain|clear|unsure",
    "i am trying to find|work|figure|understand|learn|remember out?",
    "i would like|love to",
    "it is|was not clear|known to? me?",
    "please|kindly? explain|describe to? me|us?",
    "please|kindly? tell|say|get|give|find|look|log|show|output|check|think|hear|know out|up|me?",
    "i think|hear|see",
};

/// What asks somebody to tell in one of these words.
constexpr std::string_view kBeforeTelling[] = {
    "please|kindly? can|could|would|will you please|kindly|just|quickly?",
};

bool asks_to_tell(std::string_view word) {
  return is_any(word, {"describe", "summarise", "summarize", "summary", "recap", "enumerate",
                       "list", "name", "count", "walk", "take"});
}

/// What asks whether something is so.
constexpr std::string_view kWhetherBeginnings[] = {
    "please|kindly|just? can|could|would|will? you? please|kindly|just? "
    "confirm|verify|check|advise|state|say|tell|clarify|see|know for? me|us? if|whether|that",
    "please|kindly? can|could|would|will? you? please|kindly? confirm|verify",
    "is|was it then|really|indeed? true|right|correct|so|fact|possible|the case|fact? that",
    "am i right|correct|mistaken in? thinking|assuming|believing? that",
    "is there any|some truth in",
    "i believe|think|guess|suppose|assume|suspect|hope|fear that",
    "somebody|someone|they|people says|said|say|told|claims|claim me|us? that?",
    "i have|had the feeling|impression|suspicion that?",
    "i was|am told that?",
    "can i|we tell|assume|say that? my? boss|wife|husband|family|mother? that",
};

bool begins_question(std::string_view word) {
  return is_question_word(word) || is_any(word, {"if", "whether", "whatever", "at"});
}

/// Takes what begins at a word; returns whether anything did.
bool take_beginning(std::vector<QuestionWord>& words, size_t at) {
  static const WordPatterns kPlain(kBeginnings);
  static const WordPatterns kBeforeQuestion(kBeforeQuestionWords);
  static const WordPatterns kWhether(kWhetherBeginnings);
  if (const size_t count = kWhether.count_at(words, at); count > 0 && at + count < words.size()) {
    erase_words(words, at, count);
    put_whether(words, at);
    return true;
  }
  size_t count = kPlain.count_at(words, at);
  if (count > 0 && words[at + count - 1].ends_clause && at + count < words.size() && at > 0 &&
      !words[at].begins_sentence)
    count = 0;
  const size_t before = kBeforeQuestion.count_at(words, at);
  if (before > count && at + before < words.size() && begins_question(words[at + before].text))
    count = before;
  static const WordPatterns kTold(kBeforeTelling);
  const size_t telling = kTold.count_at(words, at);
  if (telling > count && at + telling + 1 < words.size() &&
      asks_to_tell(words[at + telling].text) &&
      (words[at + telling].text != "take" || words[at + telling + 1].text == "me"))
    count = telling;
  if (count == 0 || at + count >= words.size()) return false;
  erase_words(words, at, count);
  words[at].begins_sentence = true;
  return true;
}

/// Whether a word before a beginning says nothing: "hello", "please", and not "did you".
bool is_greeting(const std::string& word) {
  return is_filler(word) && !is_any(word, {"did", "do", "does", "have", "has", "had", "you", "is",
                                           "are", "was", "were"});
}

}  // namespace

bool take_politeness(std::vector<QuestionWord>& words) {
  bool is_taken = false;
  bool is_leading = true;
  // Several may follow each other: "Do you remember, could you tell me ...".
  for (size_t at = 0; at < words.size();) {
    // Only what nothing but a greeting precedes is a beginning, or what begins a clause.
    is_leading = is_leading && (at == 0 || is_greeting(words[at - 1].text));
    const bool begins_clause = is_leading || words[at].begins_sentence ||
                               words[at - 1].ends_clause || words[at - 1].text == "and";
    if (begins_clause && words[at].text != "whether" && take_beginning(words, at))
      is_taken = true;
    else
      ++at;
  }
  return is_taken;
}

}  // namespace engram::speech
