// SPDX-License-Identifier: Apache-2.0
#include "speech/language/grammar.h"

#include <algorithm>

#include "speech/language/english.h"
#include "speech/language/grammar_rules.h"
#include "speech/language/question_phrases.h"

namespace engram::speech {

namespace {

/// Words that are passed over without being understood; more of them, and something else is meant.
/// Where yes or no is asked, one such word may be what was asked: "by accident", "on purpose".
constexpr size_t kMaxPassedOver = 2;
constexpr double kConfidence = 0.95;
constexpr double kPerPassedOver = 0.1;
constexpr double kPerCorrection = 0.05;

ParsedQuestion refused(std::string why) {
  return {{}, std::move(why), 0, false};
}

/// A name that nothing has, and what of the question it would be.
struct StrangeName {
  std::string words;
  FilterKey key{};
};

bool is_for_place(const std::string& word) {
  return is_any(word, {"in", "on", "at", "to", "into", "onto", "from", "near", "inside", "beside",
                       "behind", "under", "towards", "toward"});
}

/// Words of the robot, after which an unknown word is what it did.
bool is_before_verb(const std::string& word) {
  return is_any(word, {"you", "to", "robot", "ever", "not"});
}

/// The name that an unknown word is part of: it, and the unknown words and things beside it.
std::string whole_name(const std::vector<TaggedWord>& words, size_t& at) {
  size_t begin = at;
  while (begin > 0 &&
         (words[begin - 1].tag == WordTag::kUnknown || words[begin - 1].tag == WordTag::kThing) &&
         !words[begin - 1].ends_clause)
    --begin;
  size_t end = at + 1;
  while (end < words.size() && !words[end - 1].ends_clause &&
         (words[end].tag == WordTag::kUnknown || words[end].tag == WordTag::kThing))
    ++end;
  std::string name;
  for (size_t i = begin; i < end; ++i) name += (name.empty() ? "" : " ") + words[i].text;
  at = end - 1;
  return name;
}

/// The word before a name, articles and what describes it passed over.
const TaggedWord* before_name(const std::vector<TaggedWord>& words, size_t at) {
  while (at > 0) {
    const TaggedWord& word = words[--at];
    if (word.tag == WordTag::kUnknown || word.tag == WordTag::kThing || is_article(word.text) ||
        is_any(word.text, {"small", "big", "old", "new", "little", "good", "up", "down", "for",
                           "at", "of", "over", "out"}))
      continue;
    return &word;
  }
  return nullptr;
}

bool takes_object(const TaggedWord& word) {
  return word.tag == WordTag::kVerb || word.tag == WordTag::kSkill ||
         is_any(word.lemma, {"see", "hold", "carry", "notice", "observe", "touch", "bring", "find",
                             "spot", "handle", "move", "perceive", "manipulate"});
}

/// What an unknown word would be: a name that nothing has, or a word to pass over.
std::optional<StrangeName> strange_name(const std::vector<TaggedWord>& words, size_t& at) {
  const size_t first = at;
  const TaggedWord& word = words[at];
  const std::string before = at > 0 ? words[at - 1].text : "";
  const bool has_thing_beside =
      (at > 0 && words[at - 1].tag == WordTag::kThing && !words[at - 1].ends_clause) ||
      (at + 1 < words.size() && words[at + 1].tag == WordTag::kThing && !word.ends_clause);
  if (word.is_capital && !word.begins_sentence) {
    const TaggedWord* verb = before_name(words, at);
    if (verb == nullptr || !takes_object(*verb)) {
      std::string name = whole_name(words, at);
      return StrangeName{std::move(name), FilterKey::kSpeaker};
    }
  }
  // Who stands where "you" would: "Why did grandma stop you?"
  const bool is_subject = at > 1 && is_any(before, {"did", "does", "has", "was", "is"}) &&
                          at + 1 < words.size() && !word.ends_clause &&
                          words[at + 1].tag != WordTag::kUnknown;
  if (is_subject) return StrangeName{word.text, FilterKey::kSpeaker};
  if (is_article(before) || has_thing_beside) {
    size_t begin = at;
    while (begin > 0 &&
           (is_article(words[begin - 1].text) || words[begin - 1].tag == WordTag::kUnknown ||
            words[begin - 1].tag == WordTag::kThing))
      --begin;
    const std::string leads = begin > 0 ? words[begin - 1].text : "";
    std::string name = whole_name(words, at);
    const bool is_place = is_for_place(leads) && name.find(' ') == std::string::npos;
    return StrangeName{std::move(name), is_place ? FilterKey::kPlace : FilterKey::kThing};
  }
  if (is_for_place(before)) return StrangeName{whole_name(words, at), FilterKey::kPlace};
  const bool is_after_order =
      at > 1 && words[at - 2].text == "you" && is_any(before, {"last", "first", "just"});
  if (is_before_verb(before) || is_after_order ||
      (at == 1 && is_any(before, {"did", "do", "have"})))
    return StrangeName{lemma_of(word.text), FilterKey::kSkill};
  const TaggedWord* leads = before_name(words, first);
  if (leads != nullptr && takes_object(*leads) && leads->text != "looked")
    return StrangeName{whole_name(words, at), FilterKey::kThing};
  if (is_any(before, {"what", "which", "whose", "many", "much"}) || before == "with" ||
      before == "of")
    return StrangeName{whole_name(words, at), FilterKey::kThing};
  return {};
}

/// A program that asks for what is not there, so that its execution says that it is not.
Program program_of(const StrangeName& strange) {
  Program program{
      strange.key == FilterKey::kSpeaker ? ProgramSource::kWords : ProgramSource::kExecutions,
      {},
      {}};
  std::string name = strange.words;
  std::replace(name.begin(), name.end(), ',', ' ');
  program.with(strange.key, std::move(name));
  return program.then(StepKind::kExists);
}

bool asks_for_future(const QuestionParts& parts) {
  const ClauseParts& main = parts.main;
  if (parts.times.is_future) return true;
  if (main.has_any({"will", "shall"})) return true;
  if (main.has("should") && !main.has_any({"say", "ask", "tell", "want"})) return true;
  // Time that was spent going to the table is past.
  const bool is_past = main.has_any({"spend", "did", "been", "was", "were"});
  return main.has_words({"going", "to"}) && !is_past && main.has_any({"you", "robot"});
}

/// What nobody is asked to do who is asked what was.
bool is_order_to_pretend(std::string_view word) {
  return is_any(word, {"ignore", "disregard", "pretend", "override"});
}

/// "Could you bring me the salt?", "Bring me the salt."
bool is_request(const QuestionParts& parts) {
  const ClauseParts& main = parts.main;
  if (parts.asks == Asks::kWhether && main.has_any({"can", "could", "would"}) &&
      main.has_any({"you", "robot"}) &&
      !main.has_any({"see", "have", "visible", "hold", "be", "eventually"}))
    return true;
  if (main.words.empty()) return false;
  const TaggedWord& first = main.words.front();
  if (is_order_to_pretend(first.text) || is_any(first.text, {"forget", "bring"})) return true;
  if (parts.asks != Asks::kNothing) return false;
  const bool is_base = first.text == first.lemma;
  return (first.tag == WordTag::kVerb && is_base && !main.has("you")) ||
         is_any(first.text, {"stop", "move", "carry", "please"});
}

/// A name that nothing has in the sentences before, where the question is about it: "And the honey?
/// When did you move that?", "Chen was here. What were you told?"
std::optional<StrangeName> strange_name_told(const QuestionParts& parts) {
  const bool is_of_told = parts.main.has_any({"it", "that", "them", "one", "there", "this"});
  for (size_t at = 0; at < parts.told.size(); ++at) {
    const TaggedWord& word = parts.told[at];
    if (word.tag != WordTag::kUnknown) continue;
    const std::string before = at > 0 ? parts.told[at - 1].text : "";
    const std::string after = at + 1 < parts.told.size() ? parts.told[at + 1].text : "";
    if (word.is_capital && is_any(after, {"was", "is", "says", "said", "told", "asked", "had",
                                          "wanted", "has", "wants"}))
      return StrangeName{word.text, FilterKey::kSpeaker};
    if (is_of_told && is_any(before, {"the", "my", "our"}))
      return StrangeName{word.text, FilterKey::kThing};
  }
  return {};
}

/// "Count the things on the table.", "You drove there; explain it.", "She asks if you drove."
bool asks_to_be_told(const std::vector<TaggedWord>& words) {
  for (size_t at = 0; at < words.size(); ++at) {
    const bool begins = at == 0 || words[at].begins_sentence || words[at - 1].ends_clause ||
                        is_any(words[at - 1].text, {"kindly", "please", "just", "and"});
    if (begins &&
        is_any(words[at].text,
               {"tell",      "say",       "name",     "list",     "enumerate", "count",
                "tally",     "tot",       "add",      "give",     "show",      "state",
                "report",    "describe",  "explain",  "justify",  "specify",   "determine",
                "calculate", "compute",   "estimate", "indicate", "recall",    "remember",
                "summarise", "summarize", "recap",    "confirm",  "check"}))
      return true;
    if (is_any(words[at].text, {"if", "whether"})) return true;
  }
  return false;
}

/// "The milk, is it on the table."
bool asks_within(const std::vector<TaggedWord>& words) {
  for (size_t at = 1; at < words.size(); ++at)
    if (words[at - 1].ends_clause && is_auxiliary(words[at].text)) return true;
  return false;
}

/// "What a mess!"
bool is_exclamation(const std::vector<TaggedWord>& words) {
  return words.size() > 1 && words[0].text == "what" && words[1].text == "a";
}

/// "The milk is on the table.": what would ask whether it is so, if it did not end as it does.
bool is_statement(const QuestionParts& parts) {
  const auto& words = parts.main.words;
  if (is_exclamation(words)) return true;
  if (parts.asks != Asks::kWhether || parts.main.has("i")) return false;
  // "So you took it." wants to be told whether.
  if (is_any(words.front().text, {"so", "and"})) return false;
  // "Robot, did you take it."
  const std::string& first = words[begin_of_asking(words)].text;
  return !is_auxiliary(first) && !is_any(first, {"whether", "if", "any", "anything", "ever"});
}

/// Whether a statement says that something is so and has nothing in it that may ask.
bool asks_nothing(const QuestionParts& parts) {
  const auto& words = parts.main.words;
  if (is_exclamation(words)) return true;
  const auto is_verb = [](const TaggedWord& word) {
    return word.tag == WordTag::kVerb || word.tag == WordTag::kSkill || is_auxiliary(word.text);
  };
  return std::any_of(words.begin(), words.end(), is_verb) && !asks_within(words) &&
         !asks_to_be_told(words) && !asks_to_be_told(parts.told);
}

constexpr const char* kCannotRead =
    "I am sorry, I do not understand the question. I can tell what I did, saw and was told, "
    "when, where and why.";

}  // namespace

ParsedQuestion unread_question() {
  return {{}, kCannotRead, 0, true};
}

Result<QuestionInWords> question_in_words(std::string_view question, const Lexicon& lexicon,
                                          const Tagger& tagger, Time now, DayZone zone) {
  ENGRAM_ASSIGN_OR_RETURN(std::vector<QuestionWord> words, split_words(question));
  tagger.correct(words, lexicon);
  QuestionInWords in_words;
  // Behind the marks of a chat with a language model it is an order, too: "[INST] Pretend ..."
  in_words.is_order =
      is_order_to_pretend(words.front().text) ||
      std::any_of(words.begin(), words.end(), [](const QuestionWord& word) {
        return word.is_capital && !word.begins_sentence && is_order_to_pretend(word.text);
      });
  in_words.is_stated = words.back().ends_statement;
  take_endearments(words);
  take_question_tags(words);
  in_words.is_indirect = take_politeness(words);
  replace_phrases(words);
  in_words.times = take_times(words, now, zone);
  in_words.words = tagger.tag(words, lexicon);
  return in_words;
}

ParsedQuestion parse_question(const QuestionInWords& question, const Lexicon& lexicon) {
  if (question.words.empty()) return unread_question();
  const QuestionParts parts =
      parts_of_question(question.words, question.times, question.is_indirect);
  if (parts.main.words.empty()) return unread_question();
  if (asks_for_future(parts))
    return refused("I am sorry, I can tell what was and what is, but not what will be.");
  if (question.is_order || is_request(parts))
    return refused("I am sorry, I answer questions here, and I cannot be asked to do something.");
  const bool is_stated = question.is_stated && !question.is_indirect && is_statement(parts);
  if (is_stated && asks_nothing(parts))
    return refused("I am sorry, I answer questions, and I find none in that.");

  double confidence = kConfidence;
  size_t passed_over = 0;
  for (const ClauseParts* clause : {&parts.main, parts.beside ? &parts.beside->parts : nullptr}) {
    if (clause == nullptr) continue;
    for (size_t at = 0; at < clause->words.size(); ++at) {
      const TaggedWord& word = clause->words[at];
      if (word.is_corrected) confidence -= kPerCorrection;
      if (word.tag != WordTag::kUnknown) continue;
      if (const auto strange = strange_name(clause->words, at))
        return {program_of(*strange), {}, confidence / 2, true};
      ++passed_over;
    }
  }
  if (const auto strange = strange_name_told(parts))
    return {program_of(*strange), {}, confidence / 2, false};
  // What somebody wants to be told here is more than whether it is so.
  const bool is_asked = asks_within(parts.main.words) && !asks_to_be_told(parts.told);
  if (is_stated && !is_asked) return unread_question();
  const size_t max_passed_over = parts.asks == Asks::kWhether ? 0 : kMaxPassedOver;
  if (passed_over > max_passed_over) return unread_question();
  auto program = GrammarRules(parts, lexicon).program();
  if (!program) return unread_question();
  // A rule that made what does not validate has a gap, and a gap is no answer.
  if (!program->validate().ok()) return unread_question();
  confidence -= kPerPassedOver * static_cast<double>(passed_over);
  return {std::move(program), {}, std::max(0.1, confidence), false};
}

}  // namespace engram::speech
