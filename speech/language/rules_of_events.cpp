// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "speech/language/grammar_rules.h"

namespace engram::speech {

/// "What would you have done if nobody had said stop?"
GrammarRules::Found GrammarRules::instead() {
  // "Suppose nobody had said stop. What was left to do?"
  const auto context_has = [this](std::initializer_list<const char*> lemmas) {
    return std::any_of(lemmas.begin(), lemmas.end(),
                       [this](const char* lemma) { return parts_.context_lemmas.contains(lemma); });
  };
  const bool is_context_stop = context_has({"stop", "interrupt", "halt"});
  const bool is_context_failure = context_has({"fail", "wrong"});
  const bool is_what_if = main_.has_words({"what", "if"});
  const bool is_kept = parts_.asks == Asks::kWhat && main_.has_words({"keep", "you", "from"});
  const bool is_cut_off =
      is_context_stop || is_context_failure || asks_about_stop() ||
      (asks_about_failure() && main_.has("after")) ||
      (parts_.beside && parts_.beside->parts.has_any({"stop", "interrupt", "halt", "fail"}));
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
  const bool is_stop = is_context_stop || is_kept || asks_about_stop() ||
                       (parts_.beside && parts_.beside->parts.has_any({"stop", "interrupt"}));
  const bool is_failure = asks_about_failure() || is_context_failure ||
                          (is_what_if && main_.has_words({"go", "fine"})) ||
                          (is_what_if && main_.has_words({"go", "well"})) || main_.has("manage") ||
                          (parts_.beside && parts_.beside->parts.has("fail")) ||
                          main_.has_any({"fall", "lose", "succeed", "drop", "work"});
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
    std::string skills = skills_of(main_);
    // The verb that was stopped is no verb of what would have been.
    if (skills.empty()) return program.then(StepKind::kInstead);
    return program.then(StepKind::kInsteadHas, std::move(skills));
  }
  return program.then(StepKind::kInstead);
}

GrammarRules::Found GrammarRules::who() {
  if (parts_.asks != Asks::kWho) return {};
  if (asks_about_stop()) {
    Program program = executions();
    program.with(FilterKey::kOutcome, "stop");
    if (has_order()) add_order(program, {});
    return program.then(StepKind::kWhoStopped);
  }
  if (asks_about_holding() ||
      (main_.has("have") && !main_.things.empty() && !main_.has_verb() && !asks_about_words())) {
    Program program{ProgramSource::kThings, {}, {}};
    add_thing(program);
    add_moment(program);
    if (thing().empty()) program.with(FilterKey::kIsHeld, "yes");
    return program.then(StepKind::kHolder);
  }
  const bool is_for = main_.has_any({"for", "behalf", "because"});
  if (!asks_about_words() && !is_for && !main_.has("need")) return {};
  if (main_.has_verb() && (!main_.things.empty() || !main_.places.empty()) &&
      !skills_of(main_).empty()) {
    Program program = executions();
    if (has_order()) add_order(program, {});
    return program.then(StepKind::kWho);
  }
  // "Who made you?" was not asked to do what.
  if (main_.words.back().text == "to" && !main_.has_any({"speak", "talk"})) return {};
  const bool is_of_plans = main_.has_any({"ask", "request", "order", "command", "want", "instruct",
                                          "need", "demand", "tell"}) ||
                           is_for;
  Program program{is_of_plans ? ProgramSource::kPlans : ProgramSource::kWords, {}, {}};
  if (is_of_plans) {
    add_thing(program);
    add_places(program);
  } else if (!thing().empty()) {
    program.with(FilterKey::kText, thing());
  }
  add_times(program);
  if (has_order() || (thing().empty() && main_.places.empty() && is_of_plans))
    add_order(program, has_order() ? std::nullopt : std::optional(StepKind::kLast));
  return program.then(StepKind::kWho);
}

GrammarRules::Found GrammarRules::why() {
  // "What did you go to the table for?"
  const bool is_what_for = parts_.asks == Asks::kWhat && main_.words.back().text == "for" &&
                           main_.has_verb() && (!main_.places.empty() || !main_.things.empty());
  if (parts_.asks != Asks::kWhy && !is_what_for) return {};
  Program program = executions();
  const bool is_again = main_.has_any({"again", "twice", "retry", "repeat"}) ||
                        main_.has_words({"second", "time"}) || main_.has_words({"second", "try"}) ||
                        main_.has_words({"second", "attempt"});
  if (is_again) {
    program.with(FilterKey::kOutcome, "problem");
    return program.then(StepKind::kFirst).then(StepKind::kReason);
  }
  if (asks_about_stop() && !asks_about_failure()) {
    // To stop moving is to stop whatever one does.
    if (main_.has("move") && main_.places.empty())
      std::erase_if(program.filters,
                    [](const ProgramFilter& filter) { return filter.key == FilterKey::kSkill; });
    program.with(FilterKey::kOutcome, "stop");
    add_order(program, StepKind::kLast);
    return program.then(StepKind::kReason);
  }
  if (asks_about_failure()) {
    program.with(FilterKey::kOutcome, "failure");
    add_order(program, StepKind::kLast);
    return program.then(StepKind::kReason);
  }
  const bool is_not_done = main_.has("not") || main_.has("never");
  if (is_not_done) {
    program.with(FilterKey::kOutcome, "problem");
    add_order(program, StepKind::kLast);
    return program.then(StepKind::kReason);
  }
  const bool is_somewhere = main_.has("be") || main_.has_any({"stand", "stay", "sit"});
  if (!main_.has_verb() && skills_of(main_).empty()) {
    // Why something is where it is: because of who put it there, or drove there.
    if (!is_somewhere || (thing().empty() && main_.places.empty())) {
      const SkillVerb* pick = verb_of_skill("pick");
      const bool is_touched =
          main_.has_any({"touch", "handle", "manipulate"}) && !thing().empty() && pick != nullptr;
      if (is_touched && !lexicon_.skills_of(*pick).empty())
        program.with(FilterKey::kSkill, lexicon_.skills_of(*pick));
      else if (!parts_.times.at || !main_.has("do"))
        return {};
    } else if (const SkillVerb* verb = verb_of_skill(thing().empty() ? "drive" : "place")) {
      const std::string skills = lexicon_.skills_of(*verb);
      if (!skills.empty()) program.with(FilterKey::kSkill, skills);
    }
  }
  add_order(program, StepKind::kLast);
  return program.then(StepKind::kWhy);
}

GrammarRules::Found GrammarRules::when() {
  const bool is_ago = parts_.asks == Asks::kHowAgo ||
                      (parts_.asks == Asks::kHowLong &&
                       (main_.has_any({"since", "ago"}) ||
                        (parts_.beside && parts_.beside->is_since && !main_.has_verb())));
  const bool is_noun = parts_.asks == Asks::kNothing && main_.has("time") && has_order();
  if (parts_.asks != Asks::kWhen && !is_ago && !is_noun) return {};
  const StepKind step = is_ago ? StepKind::kAgo : StepKind::kWhen;
  if (is_ago && parts_.beside && !main_.has_verb()) {
    auto moment = moment_of_clause();
    moment->steps.pop_back();
    return moment->then(step);
  }
  const bool is_appearing = main_.has("appear") && !thing().empty();
  if ((asks_about_sight() || is_appearing) && !main_.has_verb()) {
    Program program{ProgramSource::kThings, {}, {}};
    add_thing(program);
    add_sight_times(program);
    program.then(is_appearing || main_.has_any({"first", "initial", "earliest"})
                     ? StepKind::kFirstSeen
                     : StepKind::kLastSeen);
    return program.then(step);
  }
  if (asks_about_stop() || asks_about_failure()) {
    Program program = executions();
    program.with(FilterKey::kOutcome, asks_about_failure() ? "failure" : "stop");
    add_order(program, StepKind::kLast);
    return program.then(is_ago ? step : StepKind::kEnded);
  }
  if (asks_about_words()) {
    const bool is_of_plans = !main_.things.empty() || main_.has_any({"ask", "order", "request"});
    Program program{is_of_plans ? ProgramSource::kPlans : ProgramSource::kWords, {}, {}};
    if (is_of_plans) {
      add_thing(program);
      add_places(program);
    }
    if (!main_.persons.empty()) program.with(FilterKey::kSpeaker, any_of_names(main_.persons));
    add_times(program);
    add_order(program, StepKind::kLast);
    return program.then(step);
  }
  if (!main_.has_verb() && skills_of(main_).empty() && thing().empty() && main_.places.empty() &&
      !has_order() && !main_.has_any({"do", "start", "begin", "finish", "end", "complete"}))
    return {};
  Program program = executions();
  if (!asks_about_attempts() && asks_about_success()) program.with(FilterKey::kOutcome, "success");
  // Who was at a place has driven there.
  if (!main_.has_verb() && thing().empty() && !main_.places.empty())
    if (const SkillVerb* verb = verb_of_skill("drive"))
      if (const std::string skills = lexicon_.skills_of(*verb); !skills.empty())
        program.with(FilterKey::kSkill, skills);
  const bool is_end = main_.has_any({"finish", "end", "complete", "arrive", "reach"});
  add_order(program, main_.has_any({"start", "begin"}) && !main_.has_verb() ? StepKind::kFirst
                                                                            : StepKind::kLast);
  return program.then(is_end && !is_ago ? StepKind::kEnded : step);
}

}  // namespace engram::speech
