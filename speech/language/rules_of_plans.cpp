// SPDX-License-Identifier: Apache-2.0
// The steps of plans, and whether two things were done with the same hand. Their words mean nothing
// else, so that these rules come first.
#include "speech/language/grammar_rules.h"

namespace engram::speech {

/// "What were the steps of your last plan?", "How many steps did it have?"
GrammarRules::Found GrammarRules::planned() {
  if (!main_.has("plan") || main_.has_verb() || parts_.beside) return {};
  // What would have come next is told by what ended the plan.
  if (asks_about_failure() || asks_about_stop() || asks_about_success() ||
      main_.has_any({"would", "next", "left", "remain", "still", "else", "instead", "then", "not"}))
    return {};
  const bool is_what = parts_.asks == Asks::kWhat || parts_.asks == Asks::kWhich;
  const bool is_number = main_.has_any({"count", "number", "total"});
  const bool is_count =
      parts_.asks == Asks::kHowMany || (is_number && (is_what || parts_.asks == Asks::kNothing));
  const bool is_of_steps = main_.has_any({"step", "skill", "action"});
  const bool is_of_task = main_.has("do") && main_.has_any({"task", "job"});
  const bool is_list =
      is_what || (parts_.asks == Asks::kNothing && main_.has_any({"list", "name"}));
  if (!is_count && !(is_list && (is_of_steps || is_of_task))) return {};
  if (is_count && !is_of_steps) return {};
  Program program{ProgramSource::kPlans, {}, {}};
  add_thing(program);
  add_places(program);
  if (!main_.persons.empty()) program.with(FilterKey::kSpeaker, any_of_names(main_.persons));
  add_times(program);
  add_order(program, StepKind::kLast);
  return is_count ? program.then(StepKind::kHowMany, "step")
                  : program.then(StepKind::kWhich, "skill");
}

/// "Did you pick up the salt with the same hand as the tea?"
GrammarRules::Found GrammarRules::same_hand() {
  const bool is_whether = parts_.asks == Asks::kWhether || parts_.asks == Asks::kNothing;
  if (!is_whether || !main_.has_any({"hand", "arm", "gripper"}) ||
      !(main_.has("same") || (main_.has("one") && main_.has("both"))))
    return {};
  std::vector<std::string> things = main_.things;
  std::string skills = skills_of(main_);
  if (parts_.beside) {
    const ClauseParts& beside = parts_.beside->parts;
    things.insert(things.end(), beside.things.begin(), beside.things.end());
    if (skills.empty()) skills = skills_of(beside);
  }
  if (things.size() != 2 || main_.has_any({"not", "different"})) return {};
  const auto hand_of = [&](const std::string& thing) {
    Program program{ProgramSource::kExecutions, {}, {}};
    if (!skills.empty()) program.with(FilterKey::kSkill, skills);
    program.with(FilterKey::kThing, thing);
    if (parts_.times.during) program.with(FilterKey::kDuring, *parts_.times.during);
    return program.then(StepKind::kLast).then(StepKind::kWhich, "hand");
  };
  Program program = hand_of(things[0]);
  program.steps.push_back(
      {StepKind::kEquals, Argument{{}, std::make_shared<const Program>(hand_of(things[1]))}});
  return program;
}

}  // namespace engram::speech
