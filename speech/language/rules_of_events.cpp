// SPDX-License-Identifier: Apache-2.0
// Who, why and when.
#include "speech/language/grammar_rules.h"

namespace engram::speech {

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
      const std::string pick_skills = skills_called({"pick"});
      const bool is_touched = main_.has_any({"touch", "handle", "manipulate"}) && !thing().empty();
      if (is_touched && !pick_skills.empty())
        program.with(FilterKey::kSkill, pick_skills);
      else if (!parts_.times.at || !main_.has("do"))
        return {};
    } else {
      add_skills(program, {thing().empty() ? "drive" : "place"});
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
    program.then((is_appearing && !main_.has("last")) ||
                         main_.has_any({"first", "initial", "earliest", "oldest"})
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
  if (!main_.has_verb() && thing().empty() && !main_.places.empty()) add_skills(program, {"drive"});
  const bool is_end = main_.has_any({"finish", "end", "complete", "arrive", "reach"});
  add_order(program, main_.has_any({"start", "begin"}) && !main_.has_verb() ? StepKind::kFirst
                                                                            : StepKind::kLast);
  return program.then(is_end && !is_ago ? StepKind::kEnded : step);
}

}  // namespace engram::speech
