// SPDX-License-Identifier: Apache-2.0
// Whether a program says what its question says. Rules take the words that they know; what they
// leave may be what the question was about, and an answer to another question, with evidence, is
// worse than none. So whatever names something, denies, bounds or counts has to be in the program.
#include <algorithm>

#include "speech/language/grammar_rules.h"
#include "speech/language/words.h"
#include "speech/program/filter_texts.h"

namespace engram::speech {

namespace {

/// The names that the filters of a program, and of those in it, have of one key.
void add_names(const Program& program, FilterKey key, std::vector<std::string>& names) {
  const auto add_inner = [&](const Argument& argument) {
    if (argument.program) add_names(*argument.program, key, names);
  };
  for (const ProgramFilter& filter : program.filters) {
    add_inner(filter.value);
    if (filter.key != key) continue;
    for (std::string& name : names_in_list(filter.value.text)) names.push_back(std::move(name));
  }
  for (const ProgramStep& step : program.steps)
    if (step.argument) add_inner(*step.argument);
}

bool has_filter(const Program& program, FilterKey key) {
  std::vector<std::string> names;
  add_names(program, key, names);
  return !names.empty();
}

/// Whether each of these names is one that a filter of the program has.
bool are_named(const Program& program, const std::vector<std::string>& wanted,
               std::initializer_list<FilterKey> keys) {
  std::vector<std::string> names;
  for (const FilterKey key : keys) add_names(program, key, names);
  return std::all_of(wanted.begin(), wanted.end(), [&](const std::string& one) {
    return std::find(names.begin(), names.end(), one) != names.end();
  });
}

bool has_program_step(const Program& program, std::initializer_list<StepKind> kinds) {
  return std::any_of(kinds.begin(), kinds.end(),
                     [&](StepKind kind) { return program.has_step(kind); });
}

/// Whether a value is compared with that of the very same records.
bool compares_itself(const Program& program) {
  return std::any_of(program.steps.begin(), program.steps.end(), [&](const ProgramStep& step) {
    return step.argument && step.argument->program &&
           step.argument->program->source == program.source &&
           step.argument->program->filters == program.filters;
  });
}

/// Whether a word says in which way something was done: "gently".
bool is_manner(const std::string& word) {
  return word.size() > 4 && word.ends_with("ly") &&
         !is_any(word, {"really",     "actually",       "currently",   "recently",   "previously",
                        "finally",    "eventually",     "possibly",    "probably",   "successfully",
                        "apparently", "lately",         "originally",  "physically", "personally",
                        "certainly",  "definitely",     "immediately", "directly",   "supposedly",
                        "presently",  "unsuccessfully", "smoothly",    "perfectly",  "early",
                        "correctly",  "badly"});
}

/// Whether a program tells what would have been.
bool tells_instead(const Program& program) {
  return has_program_step(program, {StepKind::kInstead, StepKind::kInsteadHas,
                                    StepKind::kInsteadNext, StepKind::kInsteadWhere});
}

bool asks_which(const Program& program, std::string_view what) {
  return std::any_of(program.steps.begin(), program.steps.end(), [&](const ProgramStep& step) {
    return (step.kind == StepKind::kWhich || step.kind == StepKind::kHowMany) && step.argument &&
           step.argument->text == what;
  });
}

}  // namespace

bool GrammarRules::is_beyond_programs() const {
  // What lies between two events, and what was not done, are other questions than these words
  // without "between" and "not".
  if (main_.has("between")) return true;
  const bool is_cut_off = asks_about_failure() || asks_about_stop();
  const bool is_list = parts_.asks == Asks::kWhich || parts_.asks == Asks::kWhat ||
                       parts_.asks == Asks::kWhere || parts_.asks == Asks::kWho ||
                       parts_.asks == Asks::kHowMany;
  // No program compares which things were the same, or tells what is left of a plan.
  if (is_superlative() && main_.has_any({"distance", "far"})) return true;
  if (main_.has("same") || main_.has_any({"closer", "nearer"})) return true;
  if (main_.has("plan") && main_.has_any({"step", "left"}) && !is_cut_off) return true;
  // What is usual, which is used less, and what took longer than some time, no program tells; nor
  // what was done twice.
  if (main_.has_any({"usually", "normally", "average", "less", "fewer"}) && !main_.has("than") &&
      !main_.has("would"))
    return true;
  const bool is_counted =
      parts_.asks == Asks::kWhether || parts_.asks == Asks::kWhich || parts_.asks == Asks::kWhat;
  if (is_counted && main_.has("twice") && !is_cut_off) return true;
  if (main_.has("than") && is_list) return true;
  // Whether something is not so is asked for by nothing but what is so.
  if (parts_.asks == Asks::kWhether && main_.has("not") && main_.has_any({"is", "are"}) &&
      !main_.places.empty() && !is_cut_off)
    return true;
  // A clause of time that nothing understood would be passed over.
  if ((is_list || parts_.asks == Asks::kHowOften) && !is_cut_off && !main_.has("would"))
    for (size_t at = 0; at + 1 < main_.words.size(); ++at)
      if ((main_.words[at].text == "after" || main_.words[at].text == "before") &&
          !main_.words[at].ends_clause)
        return true;
  if (parts_.asks != Asks::kWhen && parts_.asks != Asks::kNothing && !main_.has("would"))
    for (size_t at = 1; at + 1 < main_.words.size(); ++at)
      if (!main_.words[at].ends_clause &&
          (main_.words[at].text == "while" || (main_.words[at].text == "when" && !is_cut_off)))
        return true;
  // There are two hands.
  for (size_t at = 1; at < main_.words.size(); ++at)
    if (main_.words[at].lemma == "hand" && number_named(main_.words[at - 1].text) > 2) return true;
  const bool is_would = main_.has("would") || main_.has("if");
  // Superlatives of counts, and that nothing else was done, are other questions, too.
  if (main_.has_any({"most", "least", "only", "except"}) && !is_would && !has_order()) return true;
  if (is_list && main_.has_any({"not", "never"}) && !is_would && !is_cut_off) return true;
  return false;
}

bool GrammarRules::names_are_said(const Program& program) const {
  if (!are_named(program, main_.things, {FilterKey::kThing, FilterKey::kText})) return false;
  // "Where is it, on the table or on the counter?" is answered whatever it names.
  const bool tells_place = program.has_step(StepKind::kWhere);
  if (!tells_place && !are_named(program, main_.places, {FilterKey::kPlace, FilterKey::kText}))
    return false;
  if (!asks_which(program, "hand") && !program.has_step(StepKind::kHolder) &&
      !are_named(program, main_.hands, {FilterKey::kHand}))
    return false;
  // Whose words caused something is told with the cause, whoever the question names.
  const bool tells_whose =
      tells_instead(program) || has_program_step(program, {StepKind::kWho, StepKind::kWhoStopped,
                                                           StepKind::kWhy, StepKind::kReason});
  return tells_whose || are_named(program, main_.persons, {FilterKey::kSpeaker, FilterKey::kText});
}

bool GrammarRules::is_of_who_is_asked(const Program& program) const {
  const bool is_of_words =
      program.source == ProgramSource::kWords || program.source == ProgramSource::kPlans ||
      main_.has("would") || has_filter(program, FilterKey::kSpeaker) ||
      (asks_about_stop() && is_of_robot()) ||
      has_program_step(program, {StepKind::kWho, StepKind::kWhoStopped, StepKind::kSaid,
                                 StepKind::kWhy, StepKind::kReason});
  const auto& words = main_.words;
  for (size_t at = 0; at < words.size(); ++at) {
    // "Did she ...", "What do they ..."
    const bool is_subject =
        at == 0 || is_any(words[at - 1].text, {"did", "does", "do", "has", "have", "had", "was",
                                               "were", "is", "are", "what", "who"});
    if (!is_of_words && is_subject &&
        is_any(words[at].text,
               {"he", "she", "they", "people", "somebody", "someone", "everybody", "everyone"}))
      return false;
    // "What did you say?" is not about what was said to the robot.
    if (at > 0 && words[at - 1].text == "you" &&
        is_any(words[at].text, {"say", "tell", "ask", "speak", "shout"}) && is_of_words)
      return false;
    // "Did you stop Ada?" is no question about who stopped the robot.
    if (words[at].lemma != "stop" && words[at].lemma != "interrupt") continue;
    const bool is_by_robot = at > 0 && words[at - 1].text == "you";
    if (is_by_robot && at + 1 < words.size() && words[at + 1].tag == WordTag::kPerson) return false;
    if (is_by_robot && program.has_step(StepKind::kWhoStopped)) return false;
  }
  // "Did Ada stop?", "Did Ada pick up the salt?": what persons do is not known but for what they
  // say.
  for (size_t at = 0; at + 1 < words.size(); ++at) {
    if (!is_any(words[at].text, {"did", "does", "has", "had", "was", "is"}) ||
        words[at + 1].tag != WordTag::kPerson)
      continue;
    // "Why did Ada say so?" asks for what she had in mind.
    const bool is_why = at > 0 && words[at - 1].text == "why";
    if (is_why && asks_about_words() && !main_.has("to")) return false;
    const bool stops_robot = asks_about_stop() && (main_.has("you") || main_.has("robot"));
    if (!asks_about_words() && !stops_robot) return false;
  }
  return true;
}

bool GrammarRules::bounds_are_said(const Program& program) const {
  const bool is_cut_off = asks_about_failure() || asks_about_stop();
  const bool is_whether = parts_.asks == Asks::kWhether || parts_.asks == Asks::kNothing;
  const auto& words = main_.words;
  const bool is_of_both = program.has_step(StepKind::kEquals);
  if (main_.has_any({"never", "except", "besides"}) || (main_.has("both") && !is_of_both))
    return false;
  if (main_.has("on_purpose") || main_.has("always") || main_.has_words({"all", "the", "time"}))
    return false;
  const bool is_of_state =
      program.source == ProgramSource::kThings || program.source == ProgramSource::kRobot;
  if (is_whether && main_.has("because") && !asks_about_stop()) return false;
  if (is_whether && main_.has("where") && !is_of_state) return false;
  if (parts_.asks == Asks::kWhy && main_.has_any({"before", "after", "than"})) return false;
  if (main_.has("twice") && parts_.asks != Asks::kWhy) return false;
  if (main_.has_words({"instead", "of"}) || main_.has_words({"apart", "from"}) ||
      main_.has_words({"but", "not"}))
    return false;
  if (main_.has("else") && !main_.has_any({"or", "would"})) return false;
  if (main_.has("without") && !is_cut_off && !main_.has_any({"success", "succeed"})) return false;
  // "Didn't you ..." asks whether; "When did you not ..." asks something else.
  if (main_.has("not") && !is_whether && !is_cut_off && parts_.asks != Asks::kWhy &&
      !main_.has("would"))
    return false;
  if (main_.has_any({"under", "behind", "beside", "inside"})) return false;
  if (is_whether && main_.things.size() > 1 && !is_of_both && !main_.has("or") &&
      !main_.has("than") && !main_.has_any({"before", "after"}))
    return false;
  if (main_.places.size() > 1 && !main_.has("or") && !main_.has_any({"than", "before", "after"}))
    return false;
  // Numbers and dates that are no part of a time that was understood.
  for (size_t at = 0; at < words.size(); ++at) {
    const std::string& text = words[at].text;
    const bool is_number =
        number_named(text) > 1 || text.find_first_of("0123456789") != std::string::npos;
    // "To the left of the table" is no hand, and how it was done is not recorded.
    if (is_any(text, {"left", "right"}) && at + 1 < words.size() && words[at + 1].text == "of" &&
        !main_.has_any({"hand", "arm"}))
      return false;
    if (is_whether && is_manner(text)) return false;
    const bool is_of_hands = at + 1 < words.size() && words[at + 1].lemma == "hand";
    if (is_number && words[at].tag != WordTag::kThing && words[at].tag != WordTag::kPlace &&
        !is_of_hands)
      return false;
    if (is_any(text, {"january", "february", "march", "april", "june", "july", "august",
                      "september", "october", "november", "december", "year", "years", "month",
                      "months", "summer", "winter", "spring", "autumn"}))
      return false;
  }
  return !compares_itself(program);
}

bool GrammarRules::verbs_are_said(const Program& program) const {
  // What these did nothing records: they are read so that they are not taken for names.
  // What somebody else lost may be asked for.
  const bool is_mine = main_.has("i") && has_program_step(program, {StepKind::kLastSeen});
  if (main_.has_any({"drop", "lose", "fall"}) && !asks_about_failure() && !is_mine) return false;
  const auto& words = main_.words;
  for (size_t at = 0; at + 1 < words.size(); ++at)
    if (words[at].text == "you" &&
        is_any(words[at + 1].text, {"think", "like", "hope", "wish", "feel", "almost", "wait",
                                    "love", "hate", "know", "knew", "must", "may", "might"}))
      return false;
  if (program.source != ProgramSource::kExecutions) return true;
  const bool has_skill =
      has_filter(program, FilterKey::kSkill) || has_filter(program, FilterKey::kOutcome);
  if (has_skill || has_program_step(program, {StepKind::kWhich, StepKind::kEvents})) return true;
  // Without a verb that it knows, a question about a thing or place is about something else than
  // what was done with it.
  const bool is_of_deeds =
      main_.has_any({"do", "touch", "handle", "manipulate", "deal", "happen", "work", "busy",
                     "action", "activity", "task", "job", "step", "move", "try", "attempt"});
  const bool is_of_one =
      has_filter(program, FilterKey::kThing) || has_filter(program, FilterKey::kPlace);
  return !is_of_one || is_of_deeds || asks_about_words();
}

bool GrammarRules::endings_are_said(const Program& program) const {
  const bool tells_ending =
      has_program_step(program, {StepKind::kReason, StepKind::kSucceeded, StepKind::kRetried,
                                 StepKind::kNone, StepKind::kWhy, StepKind::kWhoStopped});
  const bool has_ending = tells_ending || has_filter(program, FilterKey::kOutcome);
  if (asks_about_failure() && !has_ending) return false;
  const bool is_of_words =
      program.source == ProgramSource::kWords || program.source == ProgramSource::kPlans;
  if (asks_about_stop() && !has_ending && !is_of_words) return false;
  const bool has_order_step = has_program_step(
      program, {StepKind::kFirst, StepKind::kLast, StepKind::kNth, StepKind::kFirstSeen,
                StepKind::kLastSeen, StepKind::kLongest, StepKind::kShortest, StepKind::kNext,
                StepKind::kPrevious, StepKind::kRetried});
  // "The last known location" is where it is.
  if (has_order() && !has_order_step && !main_.has("know")) return false;
  if (is_superlative() && !has_program_step(program, {StepKind::kLongest, StepKind::kShortest,
                                                      StepKind::kMoreThan, StepKind::kLessThan}))
    return false;
  if (main_.has("would") && main_.has("if")) return false;
  const bool is_compared =
      has_program_step(program, {StepKind::kMoreThan, StepKind::kLessThan, StepKind::kEquals});
  return !main_.has("than") || is_compared;
}

bool GrammarRules::says_all(const Program& program) const {
  // What would have been is told by the plan, however it is denied and bounded.
  if (tells_instead(program)) return names_are_said(program);
  return endings_are_said(program) && names_are_said(program) && is_of_who_is_asked(program) &&
         bounds_are_said(program) && verbs_are_said(program);
}

}  // namespace engram::speech
