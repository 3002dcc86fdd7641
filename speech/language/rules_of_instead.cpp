// SPDX-License-Identifier: Apache-2.0
// What would have been, or was still to be done.
#include <algorithm>

#include "speech/language/grammar_rules.h"

namespace engram::speech {

namespace {

/// What ended an action so that its plan was not carried out.
enum class CutOff { kNone, kStop, kFailure };

CutOff cut_off_of(const ClauseParts& clause) {
  if (clause.has_any({"stop", "interrupt", "halt", "abort", "cancel", "quit", "disturb"}))
    return CutOff::kStop;
  // Had it worked, it would not have failed.
  const bool is_of_ending = clause.has_any({"fail", "wrong", "miss", "unable", "mess", "problem",
                                            "error", "succeed", "work", "manage", "achieve"}) ||
                            clause.has_words({"go", "well"}) || clause.has_words({"go", "fine"}) ||
                            clause.has_words({"go", "smoothly"}) ||
                            clause.has_words({"could", "not"});
  return is_of_ending ? CutOff::kFailure : CutOff::kNone;
}

/// A main clause, and the condition that was taken out of it.
struct ConditionalParts {
  ClauseParts main;
  ClauseParts condition;
};

/// Where the words of a condition begin; the size: there is none.
size_t begin_of_condition(const std::vector<TaggedWord>& words) {
  const auto is = [&](size_t at, std::initializer_list<std::string_view> texts) {
    return at < words.size() && is_any(words[at].text, texts);
  };
  for (size_t at = 0; at < words.size(); ++at) {
    if (is(at, {"if", "unless", "assuming", "supposing", "suppose", "pretend", "imagine", "without",
                "because"}))
      return at;
    // "Had you not been told to stop", "what would you have done had nothing gone wrong".
    if (is(at, {"had"}) && (at == 0 || words[at - 1].text != "you") &&
        is(at + 1, {"you", "the", "nothing", "nobody", "no", "there", "it", "that", "they"}) &&
        (at == 0 || !is(at - 1, {"what", "where", "which", "who"})))
      return at;
    if (is(at, {"not"}) && is(at + 1, {"for"})) return at;
  }
  return words.size();
}

ConditionalParts conditional_parts(const std::vector<TaggedWord>& words) {
  const size_t begin = begin_of_condition(words);
  size_t end = begin;
  while (end < words.size() && !(end > begin && words[end - 1].ends_clause)) ++end;
  std::vector<TaggedWord> main(words.begin(), words.begin() + static_cast<ptrdiff_t>(begin));
  main.insert(main.end(), words.begin() + static_cast<ptrdiff_t>(end), words.end());
  return {ClauseParts(std::move(main)), ClauseParts({words.begin() + static_cast<ptrdiff_t>(begin),
                                                     words.begin() + static_cast<ptrdiff_t>(end)})};
}

/// Whether a clause asks of what was meant and not done.
bool is_of_intent(const ClauseParts& clause) {
  const bool is_unfinished =
      clause.has_words({"could", "not"}) && !clause.has_any({"finish", "complete", "end"});
  return is_unfinished || clause.has_words({"going", "to"}) ||
         clause.has_any({"intend", "intended", "intention", "plan", "mean", "meant", "meaning",
                         "supposed", "left", "remain", "still", "would", "wanted", "next"}) ||
         clause.has_words({"in", "mind"}) || clause.has_words({"where", "to"});
}

}  // namespace

bool GrammarRules::context_has(std::initializer_list<std::string_view> lemmas) const {
  return std::any_of(lemmas.begin(), lemmas.end(), [this](std::string_view lemma) {
    return parts_.context_lemmas.contains(std::string(lemma));
  });
}

bool GrammarRules::context_tells_stop() const {
  return context_has({"stop", "interrupt", "halt"});
}

/// "Where would the salt be without the stop?", "What were you going to do when it failed?"
/// The skills of what would have been done. The verb of what failed is none of it: "If picking up
/// the salt had worked, would you have placed it?"
std::string GrammarRules::skills_that_would_be() const {
  const TaggedWord* would = nullptr;
  for (const TaggedWord& word : main_.words)
    if (word.text == "would") would = &word;
  for (const TaggedWord* verb : main_.verbs)
    if (would != nullptr && verb > would)
      if (std::string skills = lexicon_.skills_of(*verb->verb); !skills.empty()) return skills;
  return skills_of(main_);
}

GrammarRules::Found GrammarRules::unfinished() {
  const bool is_of_plan = parts_.asks == Asks::kWhat || parts_.asks == Asks::kWhich ||
                          parts_.asks == Asks::kWhere || parts_.asks == Asks::kWhether ||
                          parts_.asks == Asks::kNothing;
  if (!is_of_plan) return {};
  const ConditionalParts split = conditional_parts(main_.words);
  CutOff cut_off = cut_off_of(split.condition);
  const bool is_condition = cut_off != CutOff::kNone;
  if (!is_condition && parts_.beside && parts_.beside->link != ClauseLink::kAfter)
    cut_off = cut_off_of(parts_.beside->parts);
  if (cut_off == CutOff::kNone && context_tells_stop())
    cut_off = CutOff::kStop;
  else if (cut_off == CutOff::kNone && context_has({"fail", "wrong", "could", "miss", "pretend"}))
    cut_off = CutOff::kFailure;
  const bool is_kept = parts_.asks == Asks::kWhether && asks_about_stop() &&
                       main_.has_words({"from"}) && main_.has_any({"keep", "prevent"});
  if (is_kept) cut_off = CutOff::kStop;
  const bool is_meant = is_of_intent(split.main) || is_kept || context_has({"pretend", "suppose"});
  // "Without the failed grasp" is a condition only of what would be.
  if (cut_off == CutOff::kNone || !is_meant) return {};
  Program program{ProgramSource::kExecutions, {}, {}};
  add_thing(program);
  program.with(FilterKey::kOutcome, cut_off == CutOff::kStop ? "stop" : "failure");
  program.then(StepKind::kLast);
  if (parts_.asks == Asks::kWhere || split.main.has("where"))
    return program.then(StepKind::kInsteadWhere);
  if (split.main.has("next")) return program.then(StepKind::kInsteadNext);
  std::string skills = skills_of(split.main);
  const bool is_whether =
      parts_.asks == Asks::kWhether || (parts_.asks == Asks::kNothing && !skills.empty());
  if (!is_whether) return program.then(StepKind::kInstead);
  if (skills.empty()) return {};
  return program.then(StepKind::kInsteadHas, std::move(skills));
}

/// "What would you have done if nobody had said stop?"
GrammarRules::Found GrammarRules::instead() {
  // "Suppose nobody had said stop. What was left to do?"
  const auto clause_has = [this](std::initializer_list<std::string_view> lemmas) {
    return parts_.beside && parts_.beside->parts.has_any(lemmas);
  };
  const bool is_context_failure = context_has({"fail", "wrong"});
  const bool is_what_if = main_.has_words({"what", "if"});
  const bool is_kept = parts_.asks == Asks::kWhat && main_.has_words({"keep", "you", "from"});
  const bool is_cut_off = context_tells_stop() || is_context_failure || asks_about_stop() ||
                          (asks_about_failure() && main_.has("after")) ||
                          clause_has({"stop", "interrupt", "halt", "fail"});
  const bool is_would =
      main_.has("would") && (main_.has("have") || (main_.has("if") && is_cut_off));
  const bool is_instead = main_.has_any({"otherwise", "unless"}) || is_what_if || is_kept ||
                          (main_.has("if") && main_.has("not") && main_.has("have"));
  // "What did you do next after you were stopped?" asks of what was done.
  const bool is_after = parts_.beside && parts_.beside->link == ClauseLink::kAfter &&
                        !main_.has_any({"plan", "intend", "intention", "left", "remain", "still"});
  const bool is_left = is_cut_off && !is_after &&
                       (main_.has_any({"left", "leave", "remain", "rest", "intend", "intention",
                                       "plan", "next", "else", "still"}) ||
                        main_.has_words({"going", "to", "do"}));
  const bool is_done = main_.has_any({"did", "does"}) && !main_.has("plan");
  const bool is_next =
      main_.has("next") && (main_.has("plan") || main_.has("intend")) && is_of_robot();
  if (!is_would && !is_instead && (!is_left || is_done) && !is_next) return {};
  Program program{ProgramSource::kExecutions, {}, {}};
  add_thing(program);
  if (is_what_if && !skills_of(main_).empty()) program.with(FilterKey::kSkill, skills_of(main_));
  if (!parts_.beside) add_times(program);
  const bool is_stop =
      context_tells_stop() || is_kept || asks_about_stop() || clause_has({"stop", "interrupt"});
  const bool is_failure =
      asks_about_failure() || is_context_failure ||
      (is_what_if && (main_.has_words({"go", "fine"}) || main_.has_words({"go", "well"}))) ||
      clause_has({"fail"}) || main_.has_any({"manage", "fall", "lose", "succeed", "drop", "work"});
  // What would be in a world that is otherwise no plan tells.
  const bool is_supposed = is_what_if || main_.has("if");
  if (is_supposed && !is_stop && !is_failure && !main_.has("say") && !parts_.beside) return {};
  program.with(FilterKey::kOutcome, is_stop            ? "stop"
                                    : is_failure       ? "failure"
                                    : main_.has("say") ? "stop"
                                                       : "problem");
  add_order(program, StepKind::kLast);
  if (parts_.asks == Asks::kWhere) return program.then(StepKind::kInsteadWhere);
  if (main_.has("next") || main_.has_words({"right", "after"}))
    return program.then(StepKind::kInsteadNext);
  if (parts_.asks == Asks::kWhether) {
    std::string skills = skills_that_would_be();
    if (skills.empty()) return program.then(StepKind::kInstead);
    return program.then(StepKind::kInsteadHas, std::move(skills));
  }
  return program.then(StepKind::kInstead);
}

}  // namespace engram::speech
