// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "speech/language/english.h"

namespace engram::speech {

namespace {

/// A sequence of words, and the one that stands for it.
struct Phrase {
  std::string_view words;
  std::string_view by;
};

/// The first that fits is taken, so longer ones stand first.
constexpr Phrase kPhrases[] = {
    // Names of what is asked for.
    {"which person", "who"},
    {"what person", "who"},
    {"which human", "who"},
    {"can you name the", "which"},
    {"could you name the", "which"},
    {"can you list the", "which"},
    {"could you list the", "which"},
    {"can you list all the", "which"},
    {"on earth", "really"},
    {"in the world", "really"},
    {"the hell", "really"},
    {"the heck", "really"},
    {"is that right", "really"},
    {"is that correct", "really"},
    {"is that true", "really"},
    {"is this right", "really"},
    {"is this correct", "really"},
    {"is it so", "really"},
    {"reason for", "why"},
    {"cause of", "why"},
    {"reason why", "why"},
    {"reasons for", "why"},
    {"all the things that you", "what you"},
    {"all the things you", "what you"},
    {"everything that you", "what you"},
    {"everything you", "what you"},
    {"all that you", "what you"},
    {"the things that you", "what you"},
    {"the things you", "what you"},
    {"all you", "what you"},
    {"how many goes", "how many attempts"},
    {"the last place you saw", "where did you last see"},
    {"the last place where you saw", "where did you last see"},
    {"the place where you", "where you"},
    {"the spot where you", "where you"},
    {"the time when you", "when you"},
    {"the moment when you", "when you"},
    {"the hand you", "which hand you"},
    {"the hand that you", "which hand you"},
    {"the hand with which you", "which hand you"},
    {"the person who", "who"},
    {"the one who", "who"},
    {"the reason you", "why you"},
    {"time of", "when"},
    {"have you got", "do you hold"},
    {"do you have", "do you hold"},
    {"got hold", "held"},
    {"did you have in", "did you hold in"},
    {"do you have in", "do you hold in"},
    {"list all the", "which"},
    {"list all", "which"},
    {"list the", "which"},
    {"list everything that", "what"},
    {"list everything", "what"},
    {"enumerate the", "which"},
    {"name all the", "which"},
    {"name the", "which"},
    {"name all", "which"},
    {"what is the number of", "how many"},
    {"what was the number of", "how many"},
    // Places.
    {"in front of your eyes", "visible"},
    {"before your eyes", "visible"},
    {"come into view", "seen"},
    {"came into view", "seen"},
    {"come into sight", "seen"},
    {"came into sight", "seen"},
    {"come in sight", "seen"},
    {"caught sight of", "saw"},
    {"catch sight of", "see"},
    {"lay eyes on", "see"},
    {"laid eyes on", "saw"},
    {"set eyes on", "see"},
    {"come across", "see"},
    {"came across", "saw"},
    {"in front of what", "where"},
    {"in front of which", "where"},
    {"in front of", "at"},
    {"next to", "at"},
    {"close to", "at"},
    {"on top of", "on"},
    {"from which surface", "from where"},
    {"from what surface", "from where"},
    {"from which place", "from where"},
    {"from which location", "from where"},
    {"on which surface", "where"},
    {"on what surface", "where"},
    {"onto which surface", "where"},
    {"to which surface", "where"},
    {"to which place", "where"},
    {"to which location", "where"},
    {"at which surface", "where"},
    {"at which location", "where"},
    {"in which location", "where"},
    {"at what place", "where"},
    {"in what place", "where"},
    {"which location", "where"},
    {"in which places", "where"},
    {"at which places", "where"},
    {"which surface", "where"},
    {"which places", "where"},
    {"what places", "where"},
    {"what location", "where"},
    {"what spot", "where"},
    {"which spot", "where"},
    {"by what were you", "where were you"},
    {"on what did", "where did"},
    {"on what does", "where is"},
    {"on what is", "where is"},
    {"on what was", "where was"},
    {"at what were you", "where were you"},
    {"at what are you", "where are you"},
    {"the place of", "location of"},
    {"what place is", "where is"},
    {"current place of", "location of"},
    // Hands.
    {"in one of your hands", "in your hand"},
    {"in either of your hands", "in your hand"},
    {"in any of your hands", "in your hand"},
    {"in either hand", "in your hand"},
    {"in your grip", "in your hand"},
    {"in your grasp", "in your hand"},
    {"in your possession", "in your hand"},
    {"a hold of", "hold of"},
    {"get hold of", "pick up"},
    {"got hold of", "picked up"},
    {"getting hold of", "picking up"},
    {"take hold of", "pick up"},
    {"took hold of", "picked up"},
    {"taking hold of", "picking up"},
    {"got your hands on", "picked up"},
    {"get your hands on", "pick up"},
    // What is said.
    {"gave you the task", "asked you"},
    {"gave you the order", "asked you"},
    {"gave you the job", "asked you"},
    {"gave you the command", "asked you"},
    {"gave you the instruction", "asked you"},
    {"give you the task", "ask you"},
    {"give you the order", "ask you"},
    {"gave the order", "asked"},
    {"gave the command", "asked"},
    {"were you given", "were you asked"},
    {"have you been given", "have you been asked"},
    {"were you supposed to", "were you asked to"},
    {"did you get told", "were you told"},
    {"send you", "ask you"},
    {"sent you", "asked you"},
    // What is done.
    {"were you up to", "were you doing"},
    {"are you up to", "are you doing"},
    {"have you been up to", "have you done"},
    {"keeping you busy", "doing"},
    {"kept you busy", "did you do"},
    {"were you busy with", "were you doing"},
    {"were you occupied with", "were you doing"},
    {"were you working on", "were you doing"},
    {"was going on", "happened"},
    {"is going on", "happens"},
    {"went on", "happened"},
    {"took place", "happened"},
    {"did it take you to", "did you"},
    {"did it take to", "did you"},
    {"have another try", "retry"},
    {"had another try", "retry"},
    {"another go", "again"},
    {"a second time", "again"},
    {"once more", "again"},
    {"one more time", "again"},
    {"a second try", "again"},
    {"a second attempt", "again"},
    {"another attempt", "again"},
    {"another try", "again"},
    {"two attempts", "again"},
    {"two tries", "again"},
    {"give it another", "retry"},
    {"gave it another", "retry"},
    // What goes wrong.
    {"what was the problem with", "why fail"},
    {"what was the problem when", "why fail when"},
    {"what is the problem with", "why fail"},
    {"what was the trouble with", "why fail"},
    {"what was wrong with", "why fail"},
    {"what went wrong with", "why fail"},
    {"what went wrong when", "why fail when"},
    {"what went wrong while", "why fail while"},
    {"what went wrong as", "why fail when"},
    {"what happened when you failed", "why fail"},
    {"what was the reason that", "why"},
    {"in the middle of", "while"},
    {"in the middle", "suddenly"},
    {"half way", "suddenly"},
    {"halfway", "suddenly"},
    {"in all", "altogether"},
    {"in total", "altogether"},
    {"all in all", "altogether"},
    {"all together", "altogether"},
    {"in sum", "altogether"},
    {"all of a sudden", "suddenly"},
    {"been up to", "been doing"},
    {"get up to", "do"},
    {"got up to", "did"},
    {"most recently", "last"},
    {"the most recent", "the last"},
    {"for what reason", "why"},
    {"for which reason", "why"},
    {"what is the reason for", "why"},
    {"what is the reason", "why"},
    {"what was the reason for", "why"},
    {"what was the reason", "why"},
    {"what were the reasons", "why"},
    {"what is the reason behind", "why"},
    {"what was the cause of", "why"},
    {"the reason why", "why"},
    {"the reason for", "why"},
    {"the reason", "why"},
    {"what caused you to", "why"},
    {"what caused", "why"},
    {"what made you", "why did you"},
    {"what made", "why"},
    {"what led you to", "why did you"},
    {"how come", "why"},
    {"what for", "why"},
    {"to what end", "why"},
    {"what was it that stopped", "why stop"},
    {"what stopped", "why stop"},
    {"what interrupted", "why stop"},
    {"what kept you from", "why fail"},
    {"what prevented you from", "why fail"},
    {"at what time", "when"},
    {"at which time", "when"},
    {"what time", "when"},
    {"what was the time", "when"},
    {"at what point", "when"},
    {"at which point", "when"},
    {"what moment", "when"},
    {"which moment", "when"},
    {"how many times", "how_often"},
    {"how many time", "how_often"},
    {"how often", "how_often"},
    {"the number of times", "how_often"},
    {"number of times", "how_often"},
    {"the number of", "how many"},
    {"how many seconds ago", "how_ago"},
    {"how many minutes ago", "how_ago"},
    {"how long ago", "how_ago"},
    {"how much time ago", "how_ago"},
    {"how much time", "how_long"},
    {"how many seconds", "how_long"},
    {"how many minutes", "how_long"},
    {"for how long", "how_long"},
    {"how long", "how_long"},
    {"how fast", "how_long"},
    {"how quickly", "how_long"},
    {"how many metres", "how_far"},
    {"how many meters", "how_far"},
    {"how much distance", "how_far"},
    {"what distance", "how_far"},
    {"which distance", "how_far"},
    {"how far", "how_far"},
    {"how large a distance", "how_far"},
    {"in which place", "where"},
    {"at which place", "where"},
    {"what place", "where"},
    {"which place", "where"},
    {"whereabouts", "where"},
};

/// Roundabout beginnings. What ends with '?' makes a question of what follows.
constexpr std::string_view kPoliteBeginnings[] = {"can you confirm that",
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
                                                  "say",
                                                  "may i ask",
                                                  "can i ask"};

std::vector<std::string_view> parts_of_phrase(std::string_view phrase) {
  std::vector<std::string_view> parts;
  while (!phrase.empty()) {
    const size_t end = std::min(phrase.find(' '), phrase.size());
    parts.push_back(phrase.substr(0, end));
    phrase.remove_prefix(std::min(end + 1, phrase.size()));
  }
  return parts;
}

bool is_phrase_at(const std::vector<QuestionWord>& words, size_t at,
                  const std::vector<std::string_view>& phrase) {
  if (at + phrase.size() > words.size()) return false;
  for (size_t i = 0; i < phrase.size(); ++i)
    if (words[at + i].text != phrase[i]) return false;
  return true;
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
    if (!is_here) ++at;
  }
  return is_taken;
}

void replace_phrases(std::vector<QuestionWord>& words) {
  for (size_t at = 0; at < words.size(); ++at)
    for (const Phrase& phrase : kPhrases) {
      const auto parts = parts_of_phrase(phrase.words);
      if (!is_phrase_at(words, at, parts)) continue;
      // "Everything you did" is what you did, but "was everything you did right" is not.
      if (phrase.by == "what you" && !words[at].begins_sentence) continue;
      const QuestionWord first = words[at];
      const bool ends = words[at + parts.size() - 1].ends_clause;
      words.erase(words.begin() + static_cast<ptrdiff_t>(at),
                  words.begin() + static_cast<ptrdiff_t>(at + parts.size()));
      const auto by = parts_of_phrase(phrase.by);
      for (size_t i = 0; i < by.size(); ++i)
        words.insert(words.begin() + static_cast<ptrdiff_t>(at + i),
                     QuestionWord{std::string(by[i]), first.given, i == 0 && first.begins_sentence,
                                  false, ends && i + 1 == by.size()});
      break;
    }
}

}  // namespace engram::speech
