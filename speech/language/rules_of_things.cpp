// SPDX-License-Identifier: Apache-2.0
// Where things and the robot are, what is held, and what is seen.
#include "speech/language/grammar_rules.h"

namespace engram::speech {

/// Where a thing was before it was moved: from where it was taken.
GrammarRules::Found GrammarRules::where_before() {
  const std::string taking_skills = skills_called({"pick"});
  // "Where was it before you moved it?"
  if (!thing().empty() && parts_.beside && parts_.beside->link == ClauseLink::kBefore &&
      !main_.has_verb() && !asks_about_sight() &&
      main_.has_any({"be", "been", "stand", "lie", "sit"}) &&
      parts_.beside->parts.has_any(
          {"move", "take", "grab", "pick", "grasp", "lift", "get", "touch", "handle"}) &&
      parts_.times.empty() && !taking_skills.empty()) {
    Program program{ProgramSource::kExecutions, {}, {}};
    program.with(FilterKey::kSkill, taking_skills);
    add_thing(program);
    program.then(parts_.beside->parts.has("first") ? StepKind::kFirst : StepKind::kLast);
    return program.then(StepKind::kWhere);
  }
  // "Where had it been standing before?"
  if (!thing().empty() && main_.has("before") && main_.has("had") &&
      main_.has_any({"be", "been", "stand", "lie", "sit"}) && !main_.has_verb() &&
      parts_.times.empty() && !parts_.beside && !taking_skills.empty()) {
    Program program{ProgramSource::kExecutions, {}, {}};
    program.with(FilterKey::kSkill, taking_skills);
    add_thing(program);
    return program.then(StepKind::kLast).then(StepKind::kWhere);
  }
  return {};
}

/// "Where has the salt gone?", "Where does the salt come from?"
GrammarRules::Found GrammarRules::where_gone() {
  Program program{ProgramSource::kThings, {}, {}};
  add_thing(program);
  const std::string pick_skills = skills_called({"pick"});
  if (main_.has("from") && !pick_skills.empty()) {
    program.source = ProgramSource::kExecutions;
    program.with(FilterKey::kSkill, pick_skills);
    return program.then(StepKind::kLast).then(StepKind::kWhere);
  }
  // Where it went after it was picked up is where it was placed then.
  const std::string place_skills = skills_called({"place"});
  if (parts_.beside && parts_.beside->link == ClauseLink::kAfter && !place_skills.empty()) {
    program.source = ProgramSource::kExecutions;
    program.with(FilterKey::kSkill, place_skills);
    add_times(program);
    return program.then(StepKind::kFirst).then(StepKind::kWhere);
  }
  add_moment(program);
  return program.then(StepKind::kWhere);
}

/// Where something was done with these skills.
GrammarRules::Found GrammarRules::where_done(const std::string& skills) {
  Program program = executions();
  const std::string drive_skills = skills_called({"drive"});
  const bool is_drive = skills == drive_skills;
  if (main_.has("from") && is_drive && main_.places.empty()) {
    add_order(program, StepKind::kLast);
    return program.then(StepKind::kFrom);
  }
  const bool is_right_after = parts_.beside && parts_.beside->link == ClauseLink::kAfter;
  if (is_drive && is_right_after && !has_order())
    return program.then(StepKind::kFirst).then(StepKind::kWhere);
  if (is_drive && thing().empty() && !has_order()) return program.then(StepKind::kWhere);
  add_order(program, StepKind::kLast);
  return program.then(StepKind::kWhere);
}

/// "Where was the salt when you last saw it?"
GrammarRules::Found GrammarRules::where_when_seen() {
  if (parts_.asks != Asks::kWhere || thing().empty() || main_.has_verb() || parts_.beside ||
      !parts_.times.empty() || !main_.has("when") || !main_.has("you") || !asks_about_sight() ||
      !main_.has_any({"first", "last"}))
    return {};
  Program program{ProgramSource::kThings, {}, {}};
  add_thing(program);
  program.then(main_.has("first") ? StepKind::kFirstSeen : StepKind::kLastSeen);
  return program.then(StepKind::kWhere);
}

GrammarRules::Found GrammarRules::where() {
  const bool is_noun = main_.has_any({"location", "position", "whereabouts"}) &&
                       (parts_.asks == Asks::kWhat || parts_.asks == Asks::kNothing);
  const bool is_mine = main_.has_any({"i", "we"}) && !main_.has("you");
  const bool is_lost =
      is_mine && !thing().empty() &&
      (parts_.asks == Asks::kNothing || parts_.asks == Asks::kWhether) &&
      (main_.has_words({"look", "for"}) || main_.has_words({"looking", "for"}) ||
       (main_.has("not") && main_.has_any({"find", "see"})) || main_.has_any({"search", "lose"}));
  // "What did you put the salt on?"
  const std::string last = main_.words.back().text;
  const bool is_onto = parts_.asks == Asks::kWhat && main_.has_verb() && !thing().empty() &&
                       main_.places.empty() && is_of_robot() &&
                       (last == "on" || last == "onto" || last == "from" || last == "off");
  if (parts_.asks != Asks::kWhere && !is_noun && !is_lost && !is_onto) return {};
  // Where it should have been, and where somebody was oftener, is not where it is.
  if (main_.has_any({"supposed", "meant", "intend", "often"}) && !asks_about_stop()) return {};
  if (Found found = where_before()) return found;
  if (is_lost) {
    Program program{ProgramSource::kThings, {}, {}};
    add_thing(program);
    return program.then(StepKind::kWhere);
  }
  const std::string skills = skills_of(main_);
  if (asks_about_sight() && !thing().empty() && skills.empty()) {
    Program program{ProgramSource::kThings, {}, {}};
    add_thing(program);
    if (is_mine) return program.then(StepKind::kWhere);
    add_sight_times(program);
    program.then(main_.has_any({"first", "initial", "earliest", "oldest"}) ? StepKind::kFirstSeen
                                                                           : StepKind::kLastSeen);
    return program.then(StepKind::kWhere);
  }
  if (asks_about_failure() || asks_about_stop()) {
    Program program = executions();
    program.with(FilterKey::kOutcome, asks_about_failure() ? "failure" : "stop");
    add_order(program, StepKind::kLast);
    return program.then(StepKind::kWhere);
  }
  const std::string going_skills = skills_called({"drive"});
  if (!thing().empty() && !is_of_robot() && !skills.empty() && skills == going_skills)
    return where_gone();
  if (!skills.empty()) return where_done(skills);
  if (!thing().empty()) {
    Program program{ProgramSource::kThings, {}, {}};
    add_thing(program);
    // Where it was at first, and not where it is.
    if (main_.has_any({"first", "initial"}) && !parts_.times.at && !parts_.beside)
      return program.then(StepKind::kFirstSeen).then(StepKind::kWhere);
    add_moment(program);
    return program.then(StepKind::kWhere);
  }
  if (!is_of_robot() && !(is_noun && main_.has("your"))) return {};
  Program program{ProgramSource::kRobot, {}, {}};
  add_moment(program);
  return program.then(StepKind::kWhere);
}

/// "What colour is the salt?"
GrammarRules::Found GrammarRules::coloured() {
  const bool is_what = parts_.asks == Asks::kWhat || parts_.asks == Asks::kWhich ||
                       parts_.asks == Asks::kNothing || parts_.asks == Asks::kHow;
  if (!main_.has("colour") || !is_what || thing().empty() || main_.has_verb() || parts_.beside)
    return {};
  Program program{ProgramSource::kThings, {}, {}};
  add_thing(program);
  add_moment(program);
  return program.then(StepKind::kWhich, "colour");
}

/// What the robot holds.
GrammarRules::Found GrammarRules::holding() {
  if (parts_.asks == Asks::kWhether || !asks_about_holding()) return on_place();
  if (parts_.asks != Asks::kWhat && parts_.asks != Asks::kWhich) return {};
  // What was carried to a place was placed there.
  const bool is_past_carry =
      main_.has_any({"did", "carried"}) && parts_.times.empty() && !parts_.beside;
  if (main_.has("carry") && (!main_.places.empty() || is_past_carry))
    return executions().with(FilterKey::kOutcome, "success").then(StepKind::kWhich, "thing");
  Program program{ProgramSource::kThings, {}, {}};
  program.with(FilterKey::kIsHeld, "yes");
  if (!main_.hands.empty()) program.with(FilterKey::kHand, main_.hands.front());
  add_moment(program);
  return program.then(StepKind::kWhich, "thing");
}

/// What is on a place.
GrammarRules::Found GrammarRules::on_place() {
  const bool is_what = parts_.asks == Asks::kWhat || parts_.asks == Asks::kWhich;
  if (!is_what) return {};
  if (asks_about_sight()) return seeing();
  const bool is_there =
      main_.has_any({"be", "stand", "lie", "sit", "there", "lay", "keep", "have"});
  const bool is_named =
      (main_.has_any({"thing", "object", "item"}) && main_.has("on")) || main_.has("hold");
  if (main_.places.empty() || (!is_there && !is_named) || main_.has("you") || main_.has_verb() ||
      main_.has("happen") ||
      (main_.has("do") && !(main_.has("have") && main_.has_any({"i", "we"}))))
    return {};
  Program program{ProgramSource::kThings, {}, {}};
  add_places(program);
  add_moment(program);
  return program.then(StepKind::kWhich, "thing");
}

/// What was or is in sight.
GrammarRules::Found GrammarRules::seeing() {
  Program program{ProgramSource::kThings, {}, {}};
  add_places(program);
  const bool is_past = main_.has_any({"did", "have", "has", "had", "was", "were", "been"});
  const bool is_present = is_of_present() || main_.has_any({"visible", "sight", "can"}) ||
                          (has_text("see") && !is_past);
  if (parts_.times.at || parts_.beside || (is_present && !parts_.times.during)) {
    add_moment(program);
    program.with(FilterKey::kVisible, "yes");
  } else {
    program.with(FilterKey::kDuring, parts_.times.during.value_or("always"));
  }
  if (main_.has_any({"last", "first"})) {
    std::erase_if(program.filters, [](const ProgramFilter& filter) {
      return filter.key == FilterKey::kVisible || filter.key == FilterKey::kAt;
    });
    program.then(main_.has("last") ? StepKind::kLastSeen : StepKind::kFirstSeen);
  }
  return program.then(StepKind::kWhich, "thing");
}

/// Whether the robot was at a place.
GrammarRules::Found GrammarRules::robot_at() {
  const bool is_of_position =
      is_of_robot() ||
      (main_.has("your") && main_.has_any({"position", "location", "whereabouts"}));
  if (main_.places.empty() || !is_of_position || main_.has_verb() || !thing().empty() ||
      !(main_.has_any({"be", "stand", "stay", "there"}) || parts_.times.at))
    return {};
  const bool has_moment = parts_.times.at || parts_.beside || parts_.times.is_now ||
                          main_.has_any({"is", "are", "still", "currently"});
  if (!has_moment) {
    Program program = executions();
    add_skills(program, {"drive"});
    return program.then(StepKind::kExists);
  }
  Program program{ProgramSource::kRobot, {}, {}};
  add_places(program);
  add_moment(program);
  return program.then(StepKind::kExists);
}

}  // namespace engram::speech
