// SPDX-License-Identifier: Apache-2.0
// Whether something is so, and comparisons.
#include <algorithm>

#include "speech/language/grammar_rules.h"

namespace engram::speech {

namespace {

/// The word that somebody is asked to have said, where it is one that is else passed over: "Did Ada
/// say please?"; empty: none.
std::string said_courtesy(const std::vector<TaggedWord>& words) {
  for (size_t at = 0; at + 1 < words.size(); ++at)
    if (words[at].lemma == "say" &&
        is_any(words[at + 1].text, {"please", "hello", "hi", "hey", "thanks", "thank", "sorry",
                                    "yes", "okay", "ok", "no"}))
      return words[at + 1].text;
  return {};
}

}  // namespace

/// "Did Ben ask before Ada?"
GrammarRules::Found GrammarRules::compared_persons() {
  if (main_.persons.size() != 2 || !main_.has_any({"before", "after", "earlier", "later"}))
    return {};
  const auto of = [this](const std::string& person) {
    Program program{asks_about_words() && main_.has_any({"say", "speak", "talk"})
                        ? ProgramSource::kWords
                        : ProgramSource::kPlans,
                    {},
                    {}};
    return program.with(FilterKey::kSpeaker, person).then(StepKind::kFirst).then(StepKind::kWhen);
  };
  Program first = of(main_.persons[0]);
  const StepKind how =
      main_.has_any({"after", "later"}) ? StepKind::kMoreThan : StepKind::kLessThan;
  first.steps.push_back({how, Argument{{}, std::make_shared<const Program>(of(main_.persons[1]))}});
  return first;
}

/// "Did you spend more time driving than grasping?", "Did you pick up more than you placed?"
GrammarRules::Found GrammarRules::compared_skills() {
  if (!main_.has("than") || main_.verbs.size() != 2 || main_.things.size() > 1) return {};
  const bool is_less = main_.has_any({"less", "fewer", "shorter", "faster", "quicker"});
  const bool is_time =
      main_.has_any({"time", "long", "longer", "shorter", "slower", "faster", "quicker"});
  const auto of = [&](const TaggedWord& verb) {
    Program program{ProgramSource::kExecutions, {}, {}};
    const std::string skills = lexicon_.skills_of(*verb.verb);
    program.with(FilterKey::kSkill, skills.empty() ? verb.lemma : skills);
    add_thing(program);
    const AskedTimes& times = parts_.times;
    if (times.during) program.with(FilterKey::kDuring, *times.during);
    return program.then(is_time ? StepKind::kHowLong : StepKind::kCount);
  };
  if (main_.verbs[0]->verb == main_.verbs[1]->verb) return {};
  Program first = of(*main_.verbs[0]);
  first.steps.push_back({is_less ? StepKind::kLessThan : StepKind::kMoreThan,
                         Argument{{}, std::make_shared<const Program>(of(*main_.verbs[1]))}});
  return first;
}

/// "Did it take longer to pick up the salt than the tea?", "Did you pick up the salt before the
/// tea?"
GrammarRules::Found GrammarRules::compared() {
  if (parts_.asks != Asks::kWhether && parts_.asks != Asks::kNothing) return {};
  if (Found found = compared_persons()) return found;
  if (Found found = compared_skills()) return found;
  std::vector<std::string> things = main_.things;
  if (parts_.beside)
    things.insert(things.end(), parts_.beside->parts.things.begin(),
                  parts_.beside->parts.things.end());
  if (things.size() != 2) return {};
  const bool is_longer =
      main_.has_any({"longer", "slower"}) || (main_.has("more") && main_.has("time"));
  const bool is_shorter =
      main_.has_any({"shorter", "faster", "quicker"}) || (main_.has("less") && main_.has("time"));
  const bool is_more_often = main_.has("often") && main_.has_any({"more", "than"});
  const bool is_before = main_.has("before") || main_.has("earlier") ||
                         (parts_.beside && parts_.beside->link == ClauseLink::kBefore);
  const bool is_after = main_.has("after") || main_.has("later") ||
                        (parts_.beside && parts_.beside->link == ClauseLink::kAfter);
  const auto of = [&](const std::string& one) {
    Program program{ProgramSource::kExecutions, {}, {}};
    std::string skills = skills_of(main_);
    if (skills.empty() && parts_.beside) skills = skills_of(parts_.beside->parts);
    if (!skills.empty()) program.with(FilterKey::kSkill, std::move(skills));
    program.with(FilterKey::kThing, one);
    return program;
  };
  const auto compare = [&](std::initializer_list<StepKind> steps, StepKind how) {
    Program first = of(things[0]);
    Program second = of(things[1]);
    for (const StepKind step : steps) {
      first.then(step);
      second.then(step);
    }
    first.steps.push_back({how, Argument{{}, std::make_shared<const Program>(std::move(second))}});
    return first;
  };
  if (is_longer || is_shorter)
    return compare({StepKind::kLast, StepKind::kHowLong},
                   is_longer ? StepKind::kMoreThan : StepKind::kLessThan);
  if (is_more_often)
    return compare({StepKind::kCount},
                   main_.has("less") ? StepKind::kLessThan : StepKind::kMoreThan);
  if (is_before || is_after)
    return compare({StepKind::kFirst, StepKind::kWhen},
                   is_after ? StepKind::kMoreThan : StepKind::kLessThan);
  return {};
}

GrammarRules::Found GrammarRules::whether() {
  if (parts_.asks == Asks::kNothing && main_.has_any({"everything", "all"}))
    return whether_failed();
  if (parts_.asks != Asks::kWhether) return {};
  // A comparison that no rule above understood must not be answered as something else.
  if (main_.has("than")) return {};
  if (Found found = whether_failed()) return found;
  const bool is_busy =
      main_.has_any({"busy", "active"}) || (main_.has_any({"action", "skill"}) && main_.has("run"));
  if ((is_busy || main_.has_any({"idle", "inactive"})) && !main_.has_verb() && thing().empty() &&
      main_.places.empty()) {
    Program program = executions();
    if (is_of_present()) program.with(FilterKey::kAt, "now");
    return program.then(is_busy || main_.has("action") ? StepKind::kExists : StepKind::kNone);
  }
  if (Found found = robot_at()) return found;
  if (Found found = whether_of_thing()) return found;
  if (Found found = whether_asked()) return found;
  const std::string skills = skills_of(main_);
  if (skills.empty() && thing().empty() && main_.places.empty() && main_.hands.empty()) {
    if (asks_about_success() && has_order() && main_.has_any({"action", "task", "step"})) {
      Program program = executions();
      add_order(program, {});
      return program.then(StepKind::kSucceeded);
    }
    if (asks_about_success() && is_of_robot()) {
      Program program = executions();
      program.with(FilterKey::kOutcome, "problem");
      return program.then(StepKind::kNone);
    }
    // "Did you do anything yesterday?"
    if (!main_.has_words({"do", "anything"}) && !main_.has_words({"do", "something"})) return {};
    return executions().then(StepKind::kExists);
  }
  if (skills.empty() && main_.hands.empty()) {
    if (asks_about_success() && !thing().empty())
      return executions().then(StepKind::kLast).then(StepKind::kSucceeded);
    if (main_.has_any({"touch", "handle", "manipulate", "use", "move"}) ||
        main_.has_words({"do", "anything"}) || main_.has_words({"do", "something"}))
      return executions().then(StepKind::kExists);
    return {};
  }
  Program program = executions();
  // "Are you moving?"
  const std::string& first = main_.words.front().text;
  if ((first == "are" || first == "is") && is_of_robot() && is_of_present())
    return program.with(FilterKey::kAt, "now").then(StepKind::kExists);
  // "Was the second grasp successful?"
  if (has_order() && (asks_about_success() || main_.has("work") ||
                      main_.has_words({"first", "attempt"}) || main_.has_words({"first", "try"}))) {
    add_order(program, {});
    return program.then(StepKind::kSucceeded);
  }
  // What was begun and failed was not done; whoever asks about trying wants to know of it.
  const bool is_going_on =
      parts_.times.at || (parts_.beside && parts_.beside->link == ClauseLink::kWhile);
  if (!asks_about_attempts() && !is_going_on) program.with(FilterKey::kOutcome, "success");
  return program.then(StepKind::kExists);
}

/// Whether something went wrong, was stopped, or was tried again.
GrammarRules::Found GrammarRules::whether_failed() {
  const bool is_again = main_.has_any({"again", "retry", "repeat"}) ||
                        main_.has_words({"second", "attempt"}) ||
                        main_.has_words({"second", "try"});
  if (is_again) {
    Program program = executions();
    std::erase_if(program.filters,
                  [](const ProgramFilter& filter) { return filter.value.program != nullptr; });
    if (program.find(FilterKey::kThing) == nullptr && parts_.beside &&
        !parts_.beside->parts.things.empty())
      program.with(FilterKey::kThing, any_of_names(parts_.beside->parts.things));
    if (program.find(FilterKey::kSkill) == nullptr && parts_.beside)
      if (std::string skills = skills_of(parts_.beside->parts); !skills.empty())
        program.with(FilterKey::kSkill, std::move(skills));
    program.with(FilterKey::kOutcome, "problem");
    return program.then(StepKind::kRetried);
  }
  const bool is_all = main_.has_any({"everything", "all", "every"});
  const bool is_well = main_.has_any({"well", "smoothly", "fine", "okay", "ok", "right", "good",
                                      "work", "succeed", "plan", "perfectly"});
  const bool has_no_problem = main_.has("without") && asks_about_failure();
  if ((is_all && is_well && !asks_about_failure()) || has_no_problem ||
      (main_.has("go") && is_well && !main_.has_verb())) {
    Program program = executions();
    program.with(FilterKey::kOutcome, "problem");
    return program.then(StepKind::kNone);
  }
  const bool is_none = main_.has_any({"nothing", "none", "nobody", "no"});
  if (asks_about_stop()) {
    // Whether somebody did is told by who said so.
    if (!main_.persons.empty()) {
      Program program{ProgramSource::kWords, {}, {}};
      program.with(FilterKey::kSpeaker, any_of_names(main_.persons)).with(FilterKey::kText, "stop");
      add_times(program);
      return program.then(StepKind::kExists);
    }
    Program program = executions();
    program.with(FilterKey::kOutcome, "stop");
    return program.then(is_none ? StepKind::kNone : StepKind::kExists);
  }
  if (!asks_about_failure()) return {};
  Program program = executions();
  // "Did you not manage" asks for a failure, "did you not fail" too.
  program.with(FilterKey::kOutcome, "failure");
  return program.then(is_none ? StepKind::kNone : StepKind::kExists);
}

/// Whether somebody asked for something.
GrammarRules::Found GrammarRules::whether_asked() {
  const bool is_of_words = main_.has_any({"ask", "tell", "say", "speak", "talk", "request", "order",
                                          "command", "want", "instruct", "hear"});
  if (!is_of_words) return {};
  // Whether all was done that somebody asked for is more than whether somebody asked.
  if (main_.has_any({"what", "everything", "all", "which"})) return {};
  const bool is_said =
      main_.has_any({"say", "speak", "talk", "hear"}) || (main_.has("tell") && asks_about_stop());
  Program program{is_said ? ProgramSource::kWords : ProgramSource::kPlans, {}, {}};
  if (!main_.persons.empty()) program.with(FilterKey::kSpeaker, main_.persons.front());
  if (is_said) {
    if (!thing().empty()) program.with(FilterKey::kText, thing());
    if (const std::string courtesy = said_courtesy(main_.words); !courtesy.empty())
      program.with(FilterKey::kText, courtesy);
  } else {
    // What else than a thing or a place was asked for is in no plan.
    if (main_.has_verb() && thing().empty() && main_.places.empty()) return {};
    add_thing(program);
    add_places(program);
  }
  add_times(program);
  return program.then(StepKind::kExists);
}

/// Whether a thing, or anything, is or was held; `is_of_empty_hand`: whether nothing is.
GrammarRules::Found GrammarRules::whether_held(bool is_of_empty_hand) {
  // "Have you had the salt in your hand today?" is of all that time: what was held was picked up.
  const bool is_past = !parts_.times.at && !parts_.beside && !parts_.times.is_now &&
                       (main_.has("did") || main_.has_words({"have", "you"}));
  const std::string taking_skills = skills_called({"pick"});
  if (asks_about_holding() && is_past && !thing().empty() && !taking_skills.empty()) {
    Program program = executions();
    program.with(FilterKey::kSkill, taking_skills);
    return program.with(FilterKey::kOutcome, "success").then(StepKind::kExists);
  }
  Program program{ProgramSource::kThings, {}, {}};
  add_thing(program);
  if (!main_.hands.empty()) program.with(FilterKey::kHand, main_.hands.front());
  program.with(FilterKey::kIsHeld, "yes");
  add_moment(program);
  return program.then(is_of_empty_hand ? StepKind::kNone : StepKind::kExists);
}

/// Whether a thing is or was in sight, or anything was: `is_anything`.
GrammarRules::Found GrammarRules::whether_seen(bool is_anything) {
  if (thing().empty() && !is_anything) return {};
  Program program{ProgramSource::kThings, {}, {}};
  add_thing(program);
  const bool was_asked = main_.has_any({"was", "were", "been", "did", "ever"});
  const bool is_present =
      is_of_present() || (!was_asked && main_.has_any({"visible", "sight", "can"}));
  if (parts_.times.at || parts_.beside || (is_present && !parts_.times.during)) {
    add_moment(program);
    return program.then(StepKind::kIsVisible);
  }
  // Who asks whether it was seen anywhere is looking for it.
  if (main_.has_any({"somewhere", "anywhere"}) && !thing().empty()) {
    add_sight_times(program);
    return program.then(StepKind::kLastSeen).then(StepKind::kWhere);
  }
  add_places(program);
  program.with(FilterKey::kDuring, parts_.times.during.value_or("always"));
  return program.then(StepKind::kExists);
}

/// Whether a thing is somewhere, in sight or in a hand.
GrammarRules::Found GrammarRules::whether_of_thing() {
  const bool is_anything = main_.has_any(
      {"anything", "something", "thing", "object", "item", "empty", "nothing", "full"});
  const bool is_moved =
      !thing().empty() && (main_.has("move") || main_.has("shift")) && main_.places.empty();
  if (is_moved) {
    Program program{ProgramSource::kThings, {}, {}};
    add_thing(program);
    add_times(program);
    return program.then(StepKind::kWasMoved);
  }
  if (main_.has_verb() && !skills_of(main_).empty()) return {};
  const bool is_of_empty_hand =
      main_.has_any({"hand", "hands", "gripper"}) && main_.has_any({"empty", "free"});
  if (asks_about_holding() || is_of_empty_hand) return whether_held(is_of_empty_hand);
  if (asks_about_sight()) return whether_seen(is_anything);
  const bool is_of_thing = !thing().empty() || is_anything;
  const bool is_there =
      main_.has_any({"be", "stand", "lie", "there", "sit", "have", "rest"}) || main_.has("on");
  if (!is_of_thing || main_.places.empty() || main_.has("you") || !is_there) return {};
  // Whether it ever was somewhere is no question about now.
  if (main_.has("ever")) return {};
  Program program{ProgramSource::kThings, {}, {}};
  add_thing(program);
  add_places(program);
  add_moment(program);
  return program.then(main_.has_any({"empty", "nothing"}) ? StepKind::kNone : StepKind::kExists);
}

}  // namespace engram::speech
