// SPDX-License-Identifier: Apache-2.0
// How long, how far, how often, how many, which and what.
#include "speech/language/grammar_rules.h"

namespace engram::speech {

GrammarRules::Found GrammarRules::how_long() {
  Program program = executions();
  // What lies between two events is no execution.
  if (program.filters.empty() && !has_order()) return {};
  if (main_.has("from") && main_.has("to") && main_.places.empty()) return {};
  // How long a thing was held, or the robot was somewhere, is no execution.
  const bool is_of_state =
      skills_of(main_).empty() &&
      (asks_about_holding() || (is_of_robot() && main_.has_any({"were", "been", "are"})));
  if (is_of_state) return {};
  const bool is_of_clause = parts_.beside && !main_.has_verb() && thing().empty();
  if (main_.has_any({"after", "before"}) || is_of_clause) return {};
  const bool is_of_one = has_order() || program.find(FilterKey::kSkill) != nullptr ||
                         program.find(FilterKey::kThing) != nullptr ||
                         program.find(FilterKey::kPlace) != nullptr;
  const bool is_total = main_.has_any({"altogether", "total", "overall"}) ||
                        (main_.has("spend") && thing().empty() && main_.places.empty());
  if (is_of_one && !is_total) add_order(program, StepKind::kLast);
  return program.then(StepKind::kHowLong);
}

GrammarRules::Found GrammarRules::how_far() {
  // How far away something is was never measured.
  if (!thing().empty() || !main_.hands.empty() || main_.has_any({"hand", "arm", "reach", "miss"}))
    return {};
  if (!is_of_robot() && !main_.has_verb()) return {};
  if (main_.has_any({"is", "away", "from"}) && !main_.has_verb()) return {};
  // No program tells which of several drives was the farthest.
  if (is_superlative() || parts_.asks == Asks::kWhich) return {};
  Program program = executions();
  if (program.find(FilterKey::kSkill) == nullptr) add_skills(program, {"drive"});
  if (has_order()) add_order(program, {});
  return program.then(StepKind::kHowFar);
}

/// How many persons spoke, or how often something was said or asked for.
GrammarRules::Found GrammarRules::how_many_words() {
  if (!asks_about_words()) return {};
  const bool is_of_persons = main_.has_any({"people", "person", "human", "somebody"});
  if (parts_.asks != Asks::kHowOften && is_of_persons) {
    Program program{ProgramSource::kWords, {}, {}};
    add_times(program);
    return program.then(StepKind::kHowMany, "person");
  }
  if (main_.has_verb() && !main_.has_any({"request", "command", "order", "instruction"})) return {};
  Program program{main_.has_any({"say", "speak", "talk", "word"}) ? ProgramSource::kWords
                                                                  : ProgramSource::kPlans,
                  {},
                  {}};
  if (program.source == ProgramSource::kPlans) {
    add_thing(program);
    add_places(program);
  }
  if (!main_.persons.empty()) program.with(FilterKey::kSpeaker, any_of_names(main_.persons));
  add_times(program);
  return program.then(StepKind::kCount);
}

/// How many things are somewhere, in a hand or in sight, or were seen.
GrammarRules::Found GrammarRules::how_many_things() {
  Program program{ProgramSource::kThings, {}, {}};
  add_places(program);
  if (asks_about_holding()) program.with(FilterKey::kIsHeld, "yes");
  if (asks_about_sight() && (parts_.times.at || parts_.beside)) {
    add_moment(program);
    program.with(FilterKey::kVisible, "yes");
  } else if (asks_about_sight() && !main_.has("did") &&
             (main_.has_words({"do", "you"}) || main_.has("can")))
    program.with(FilterKey::kVisible, "yes");
  else if (asks_about_sight() && !main_.has("visible"))
    program.with(FilterKey::kDuring, parts_.times.during.value_or("always"));
  else
    add_moment(program);
  return program.then(StepKind::kCount);
}

/// How long, how far, how often and how many.
GrammarRules::Found GrammarRules::amounts() {
  const bool is_how_long =
      parts_.asks == Asks::kHowLong ||
      ((parts_.asks == Asks::kNothing || parts_.asks == Asks::kWhat) && main_.has("duration"));
  if (is_how_long) return how_long();
  if (main_.has_any({"total", "altogether", "overall"}) && main_.has("time") && main_.has_verb() &&
      parts_.asks != Asks::kHowOften)
    return executions().then(StepKind::kHowLong);
  if (parts_.asks == Asks::kHowFar || main_.has("distance")) return how_far();
  // Steps of a plan are no executions, and no program counts them.
  if (main_.has("step") && main_.has("plan")) return {};
  const bool is_count = main_.has_any({"count", "number", "total"}) &&
                        (parts_.asks == Asks::kNothing || parts_.asks == Asks::kWhat);
  const bool is_often = parts_.asks == Asks::kHowOften;
  if (!is_often && parts_.asks != Asks::kHowMany && !is_count) return {};
  if (asks_about_stop() || asks_about_failure()) {
    Program program = executions();
    // What was not found was looked for.
    if (main_.has_any({"find", "locate"}) && program.find(FilterKey::kSkill) == nullptr)
      add_skills(program, {"look"});
    program.with(FilterKey::kOutcome, asks_about_stop() ? "stop" : "failure");
    return program.then(StepKind::kCount);
  }
  if (Found found = how_many_words()) return found;
  // What the robot is able to do, and how many plans it finished, no program counts.
  if (main_.has("skill") && main_.has_words({"do", "you"})) return {};
  if (!is_often && main_.has_any({"task", "job", "plan"}) && !main_.has_verb()) {
    if (main_.has_any({"finish", "complete", "end"}) || asks_about_success()) return {};
    Program program{ProgramSource::kPlans, {}, {}};
    add_times(program);
    return program.then(StepKind::kCount);
  }
  // Things that were done are actions.
  const bool is_of_things =
      main_.has_any({"thing", "object", "item", "stuff"}) && !main_.has_words({"you", "do"});
  if (!is_often && is_of_things && main_.has_any({"handle", "touch", "manipulate"}) &&
      !main_.has_verb())
    return executions().then(StepKind::kHowMany, "thing");
  if (!is_often && is_of_things && !main_.has_verb() && skills_of(main_).empty())
    return how_many_things();
  // How many hands there are is not counted.
  if (main_.has_any({"hand", "arm", "gripper"}) && !main_.has_verb() && skills_of(main_).empty())
    return {};
  Program program = executions();
  // What is tried with a thing, without a word for it, is to get it.
  if (asks_about_attempts() && program.find(FilterKey::kSkill) == nullptr && !thing().empty())
    add_skills(program, {"pick"});
  // Who was at a place has driven there.
  if (program.find(FilterKey::kSkill) == nullptr && thing().empty() && !main_.places.empty())
    add_skills(program, {"drive"});
  if (!is_often && is_of_things && !asks_about_attempts()) {
    program.with(FilterKey::kOutcome, "success");
    return program.then(StepKind::kHowMany, "thing");
  }
  if (program.filters.empty() &&
      !main_.has_any({"action", "step", "try", "attempt", "do", "activity"}))
    return {};
  if (asks_about_success()) program.with(FilterKey::kOutcome, "success");
  return program.then(StepKind::kCount);
}

GrammarRules::Found GrammarRules::which_hand() {
  // No program tells which hand holds nothing.
  if (main_.has_any({"free", "empty"})) return {};
  // "Which hand held the salt?": the one that took it.
  const std::string taking_skills = skills_called({"pick"});
  if (main_.has_any({"held", "carried", "had"}) && !main_.has_verb() && !thing().empty() &&
      !parts_.times.at && !parts_.beside && !taking_skills.empty()) {
    Program program{ProgramSource::kExecutions, {}, {}};
    program.with(FilterKey::kSkill, taking_skills);
    add_thing(program);
    add_times(program);
    add_order(program, StepKind::kLast);
    return program.then(StepKind::kWhich, "hand");
  }
  const bool is_held =
      asks_about_holding() || (main_.has("in") && main_.has_any({"is", "was"}) && !thing().empty());
  if (is_held && !main_.has_verb()) {
    Program program{ProgramSource::kThings, {}, {}};
    add_thing(program);
    add_moment(program);
    if (thing().empty()) program.with(FilterKey::kIsHeld, "yes");
    return program.then(StepKind::kHolder);
  }
  Program program = executions();
  // "Left or right" names no hand that was used.
  std::erase_if(program.filters,
                [](const ProgramFilter& filter) { return filter.key == FilterKey::kHand; });
  if (asks_about_failure()) program.with(FilterKey::kOutcome, "failure");
  add_order(program, StepKind::kLast);
  return program.then(StepKind::kWhich, "hand");
}

GrammarRules::Found GrammarRules::which() {
  // "Did you pick up the salt or the tea first?"
  const bool is_handled = main_.has_any({"handle", "touch", "manipulate"});
  if (main_.things.size() > 1 && main_.has("or") && (main_.has_verb() || is_handled) &&
      !main_.has_any({"longer", "slower", "faster", "quicker", "than"}) &&
      (parts_.asks == Asks::kWhich || parts_.asks == Asks::kWhat || has_order())) {
    Program program = executions();
    if (is_handled && program.find(FilterKey::kSkill) == nullptr) add_skills(program, {"pick"});
    add_order(program, {});
    return program.then(StepKind::kWhich, "thing");
  }
  const bool is_either = (parts_.asks == Asks::kWhether || parts_.asks == Asks::kNothing) &&
                         main_.hands.size() > 1 && main_.has("or");
  const bool is_which = parts_.asks == Asks::kWhich || parts_.asks == Asks::kWhat || is_either;
  if (asks_for_hand()) return which_hand();
  // "Which object was your action at 8:05 about?"
  if (is_which && parts_.times.at && main_.has_any({"thing", "object", "item"}) &&
      !main_.has_verb() && thing().empty() && main_.places.empty() && !asks_about_sight() &&
      !asks_about_holding() && !asks_about_words() && !asks_about_failure())
    return executions().then(StepKind::kWhich, "thing");
  if (!is_which || asks_about_words() || asks_about_sight() || asks_about_holding()) return {};
  const bool is_of_thing = main_.has_any({"thing", "object", "item"}) || parts_.asks == Asks::kWhat;
  if (is_of_thing && !main_.has_verb() && thing().empty() &&
      (main_.has_any({"handle", "touch", "manipulate", "deal"}) ||
       (main_.has("action") && main_.has("about")))) {
    Program program = executions();
    if (asks_about_failure()) {
      program.with(FilterKey::kOutcome, "failure");
    } else if (has_order()) {
      // What was handled last was picked up or placed last, and not driven past.
      add_skills(program, {"pick", "place"});
    }
    if (has_order()) add_order(program, {});
    return program.then(StepKind::kWhich, "thing");
  }
  if (is_superlative() && !main_.has_any({"object", "item"})) return {};
  if (asks_about_failure() || asks_about_stop()) {
    const bool is_thing =
        main_.has_any({"object", "item"}) || (main_.has("thing") && main_.has_verb());
    const bool is_what_verbed = parts_.asks == Asks::kWhat && main_.has_verb() &&
                                skills_of(main_).size() > 0 && thing().empty();
    if (!is_thing && !is_what_verbed) return {};
    Program program = executions();
    program.with(FilterKey::kOutcome, asks_about_failure() ? "failure" : "stop");
    if (has_order()) add_order(program, {});
    return program.then(StepKind::kWhich, "thing");
  }
  // "What did you pick up?" asks for a thing, "Which place did you drive to?" for a place.
  const std::string skills = skills_of(main_);
  if (skills.empty() || !thing().empty()) return {};
  Program program = executions();
  const std::string drive_skills = skills_called({"drive"});
  const bool is_place = !skills.empty() && skills == drive_skills;
  if (!asks_about_attempts()) program.with(FilterKey::kOutcome, "success");
  if (has_order()) add_order(program, {});
  return program.then(StepKind::kWhich, is_place && main_.places.empty() ? "place" : "thing");
}

/// "How did your day begin?", "What did you start with?"
GrammarRules::Found GrammarRules::what_at_ends() {
  const bool is_edge =
      parts_.asks == Asks::kWhat || parts_.asks == Asks::kWhich || parts_.asks == Asks::kHow;
  if (is_edge && main_.has_any({"begin", "start"}) && !main_.has_verb() && thing().empty() &&
      !parts_.times.at && !asks_about_words() && !asks_about_stop() && !asks_about_failure())
    return executions().then(StepKind::kFirst).then(StepKind::kEvents);
  if (is_edge && main_.has_any({"end", "finish"}) && !main_.has_verb() && thing().empty() &&
      (parts_.asks == Asks::kHow || main_.has("with")) && !parts_.times.at && !asks_about_words() &&
      !asks_about_stop() && !asks_about_failure())
    return executions().then(StepKind::kLast).then(StepKind::kEvents);
  return {};
}

/// What was said, or asked for.
GrammarRules::Found GrammarRules::what_was_said() {
  const bool is_of_task = main_.has_any({"task", "job"}) && !main_.has_verb() &&
                          (main_.has_any({"have", "get"}) ||
                           (main_.has("your") && main_.has_any({"was", "were"}) &&
                            !main_.has("you") && !parts_.times.at) ||
                           ((has_order() || !main_.persons.empty()) && !main_.has("did")));
  const bool is_of_stopped = asks_about_stop() && main_.has_any({"do", "action", "activity"}) &&
                             !main_.has_words({"say", "what"}) && !main_.has("did");
  const bool is_of_words = (asks_about_words() || is_of_task) && !main_.has("about") &&
                           !is_of_stopped &&
                           (parts_.asks == Asks::kWhat || parts_.asks == Asks::kWhich);
  if (!is_of_words) return {};
  const bool is_said = main_.has_any({"say", "speak", "talk", "word", "shout", "utter"}) ||
                       (main_.has("tell") && !main_.has_any({"do", "to"}));
  Program program{is_said ? ProgramSource::kWords : ProgramSource::kPlans, {}, {}};
  if (!main_.persons.empty()) program.with(FilterKey::kSpeaker, any_of_names(main_.persons));
  if (!is_said) {
    add_thing(program);
    add_places(program);
  }
  // "What did Ben say when he stopped you?"
  const bool is_of_stop =
      is_said &&
      (asks_about_stop() || (parts_.beside && parts_.beside->parts.has_any({"stop", "interrupt"})));
  if (is_of_stop)
    program.with(FilterKey::kText, "stop");
  else
    add_times(program);
  if (has_order()) add_order(program, {});
  return program.then(StepKind::kSaid);
}

/// What was done; `is_narration`: somebody wants to be told about it.
GrammarRules::Found GrammarRules::what_was_done(bool is_narration) {
  const bool is_of_doing =
      main_.has_words({"go", "well"}) || main_.has_words({"go", "right"}) ||
      (asks_about_success() && thing().empty()) ||
      main_.has_any({"do", "happen", "occur", "action", "activity", "task", "work", "job", "busy",
                     "step", "event", "accomplish", "achieve"}) ||
      is_superlative() || is_narration;
  if (!is_of_doing) return {};
  // What was done right beside something else is the one action there.
  if (parts_.beside && parts_.beside->link != ClauseLink::kWhile && !has_order() && !is_narration) {
    auto moment = moment_of_clause();
    if (moment && moment->source == ProgramSource::kExecutions && parts_.times.empty()) {
      moment->steps.pop_back();
      moment->then(parts_.beside->link == ClauseLink::kAfter ? StepKind::kNext
                                                             : StepKind::kPrevious);
      return moment->then(StepKind::kEvents);
    }
  }
  // "What did you do next after I said stop?"
  const bool is_next = parts_.beside && parts_.beside->link == ClauseLink::kAfter &&
                       main_.has_any({"next", "immediately", "directly"});
  if (is_next && !has_order() && !is_narration)
    return executions().then(StepKind::kFirst).then(StepKind::kEvents);
  if (is_superlative()) {
    Program program = executions();
    add_order(program, {});
    return program.then(StepKind::kEvents);
  }
  // "You put the milk down. What happened?" asks of what was told.
  if (main_.has("happen") && !parts_.told.empty() && parts_.times.empty() && thing().empty())
    return {};
  Program program = executions();
  const bool is_task = main_.has_any({"task", "job", "busy", "doing", "activity", "action"});
  if (parts_.times.empty() && !is_narration && !has_order() && is_of_present() && is_task)
    program.with(FilterKey::kAt, "now");
  if (asks_about_success() || main_.has_words({"go", "well"}) || main_.has_words({"go", "right"}))
    program.with(FilterKey::kOutcome, "success");
  const bool needs_place = main_.has("be") || main_.has("do");
  if (program.find(FilterKey::kPlace) != nullptr && !needs_place) return {};
  if (has_order()) add_order(program, {});
  return program.then(StepKind::kEvents);
}

/// What was done, what was said, and what went wrong.
GrammarRules::Found GrammarRules::what() {
  // "How did the grasp of the salt end?", "What was the result of picking up the salt?"
  const bool is_of_end = main_.has_any({"outcome", "result", "status"}) ||
                         (parts_.asks == Asks::kHow && main_.has_any({"end", "go", "turn"}));
  if (is_of_end && !main_.has_words({"it", "go"}) && (main_.has_verb() || has_order()) &&
      parts_.asks != Asks::kWhether) {
    Program program = executions();
    add_order(program, StepKind::kLast);
    return program.then(StepKind::kReason);
  }
  if (main_.has("skill") && !main_.has_verb() && parts_.asks != Asks::kNothing &&
      (!is_of_robot() || main_.has("run")) && (parts_.times.at || main_.has("run")))
    return executions().then(StepKind::kWhich, "skill");
  if (main_.has("know") && main_.has_any({"thing", "object", "item"}) && !main_.has_verb() &&
      (parts_.asks == Asks::kWhat || parts_.asks == Asks::kWhich)) {
    Program program{ProgramSource::kThings, {}, {}};
    return program.then(StepKind::kWhich, "thing");
  }
  const bool is_narration = main_.has_any({"summarize", "summarise", "summary", "describe",
                                           "report", "narrate", "recap", "list", "story"}) ||
                            (parts_.asks == Asks::kNothing && main_.has("about")) ||
                            (parts_.asks == Asks::kHow && main_.has("day") && main_.has("be")) ||
                            (parts_.asks == Asks::kHow && main_.has("go") && main_.has("it"));
  const bool is_what = parts_.asks == Asks::kWhat || parts_.asks == Asks::kWhich || is_narration ||
                       (parts_.asks == Asks::kNothing &&
                        (asks_about_failure() || main_.has_any({"do", "action", "activity"})));
  if (Found found = what_at_ends()) return found;
  if (!is_what) return {};
  if (main_.has("hand") && main_.has("have") && !main_.has_verb()) return {};
  // "What did you do before?": before what?
  if (main_.has_any({"before", "next"}) && !parts_.beside && parts_.times.empty() &&
      !main_.has_verb() && thing().empty() && !asks_about_failure() && !asks_about_stop())
    return {};
  // "What does the salt cost?"
  if (main_.has("does") && !is_of_robot()) return {};
  if (Found found = what_was_said()) return found;
  if (asks_about_failure() || asks_about_stop()) {
    Program program = executions();
    program.with(FilterKey::kOutcome, asks_about_failure() ? "failure" : "stop");
    if (has_order()) add_order(program, {});
    if (main_.has_any({"altogether", "count"}) && parts_.asks == Asks::kNothing)
      return program.then(StepKind::kCount);
    return program.then(StepKind::kEvents);
  }
  // "What were you doing when you were stopped?"
  if (parts_.beside && parts_.beside->link == ClauseLink::kWhile && main_.has("do") &&
      parts_.beside->parts.has_any({"stop", "interrupt", "fail"}) &&
      !parts_.beside->parts.has("say")) {
    Program program = executions_of(parts_.beside->parts);
    program.with(FilterKey::kOutcome, parts_.beside->parts.has("fail") ? "failure" : "stop");
    return program.then(StepKind::kLast).then(StepKind::kEvents);
  }
  return what_was_done(is_narration);
}

}  // namespace engram::speech
