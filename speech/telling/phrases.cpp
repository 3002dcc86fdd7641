// SPDX-License-Identifier: Apache-2.0
#include "speech/telling/phrases.h"

#include <algorithm>

#include "ltm/core/printable.h"
#include "speech/program/skill_verbs.h"

namespace engram::speech {

namespace {

/// What a verb is followed by.
struct VerbObjects {
  std::string thing;
  std::string place;
  std::string hand;
};

VerbObjects objects_of(const std::optional<ltm::MemoryId>& thing,
                       const std::optional<ltm::MemoryId>& place, const std::string& hand,
                       const KnownWorld& world) {
  return {thing ? printable(world.spoken(*thing)) : std::string(),
          place ? printable(world.spoken(*place)) : std::string(), hand};
}

std::string phrase(const std::string& skill, std::string_view SkillVerb::*form,
                   const VerbObjects& objects) {
  const SkillVerb* verb = verb_of_skill(skill);
  std::string text;
  if (verb != nullptr)
    text = verb->*form;
  else
    text = (form == &SkillVerb::base     ? "execute "
            : form == &SkillVerb::gerund ? "executing "
                                         : "executed ") +
           printable(words_of_name(skill));
  // Who drives to a place for something says first where to.
  const bool is_place_first = verb != nullptr && verb->to == "to";
  const std::string place =
      objects.place.empty()
          ? ""
          : fmt::format(" {} the {}", verb == nullptr ? "at" : verb->to, objects.place);
  if (is_place_first) text += place;
  if (!objects.thing.empty()) {
    if (verb != nullptr && !verb->thing.empty()) text += fmt::format(" {}", verb->thing);
    if (verb == nullptr) text += " with";
    text += " the " + objects.thing;
  }
  if (!is_place_first) text += place;
  if (!objects.hand.empty()) text += " with " + my_hands({objects.hand});
  return text;
}

}  // namespace

std::string joined(const std::vector<std::string>& parts) {
  std::string text;
  for (size_t i = 0; i < parts.size(); ++i) {
    if (i > 0) text += i + 1 == parts.size() ? " and " : ", ";
    text += parts[i];
  }
  return text;
}

std::string my_hands(const std::vector<std::string>& hands) {
  std::vector<std::string> words;
  for (const std::string& hand : hands) words.push_back(printable(words_of_hand(hand)));
  const bool is_whole = std::any_of(words.begin(), words.end(), says_hand);
  return fmt::format("my {}{}", joined(words),
                     is_whole           ? ""
                     : words.size() > 1 ? " hands"
                                        : " hand");
}

std::string with_article(const std::string& name) {
  const bool is_proper = !name.empty() && name.front() >= 'A' && name.front() <= 'Z';
  return is_proper ? name : "the " + name;
}

std::string past_phrase(const Execution& execution, const KnownWorld& world) {
  return phrase(execution.skill, &SkillVerb::past,
                objects_of(execution.thing, execution.place, execution.hand, world));
}

std::string base_phrase(const Execution& execution, const KnownWorld& world) {
  return phrase(execution.skill, &SkillVerb::base,
                objects_of(execution.thing, execution.place, execution.hand, world));
}

std::string gerund_phrase(const Execution& execution, const KnownWorld& world) {
  return phrase(execution.skill, &SkillVerb::gerund,
                objects_of(execution.thing, execution.place, execution.hand, world));
}

std::string base_phrase(const PlannedStep& step, const KnownWorld& world) {
  return phrase(step.skill, &SkillVerb::base, objects_of(step.thing, step.place, {}, world));
}

std::string outcome_phrase(const Execution& execution, const KnownWorld& world) {
  const std::string reason =
      execution.reason.empty() ? std::string() : ": " + printable(execution.reason);
  switch (execution.outcome) {
    case ltm::ActionOutcome::kSuccess:
      return "I " + past_phrase(execution, world);
    case ltm::ActionOutcome::kFailure:
      return fmt::format("I tried to {}, but failed{}", base_phrase(execution, world), reason);
    case ltm::ActionOutcome::kStop:
      return fmt::format("I began to {}, but was stopped{}", base_phrase(execution, world), reason);
    case ltm::ActionOutcome::kRunning:
      return fmt::format("I began to {}, and no end is known", base_phrase(execution, world));
    case ltm::ActionOutcome::kUnknown:
      break;
  }
  return fmt::format("I began to {}, and nobody knows how it ended", base_phrase(execution, world));
}

std::string words_phrase(const SpokenWords& words) {
  return fmt::format("{} said: \"{}\"",
                     words.speaker.empty() ? "somebody" : printable(words.speaker),
                     printable(words.text));
}

std::string counted(size_t count, std::string_view word) {
  return fmt::format("{} {}{}", count, word, count == 1 ? "" : "s");
}

std::string sentence(std::string text) {
  if (text.empty()) return text;
  if (text.front() >= 'a' && text.front() <= 'z')
    text.front() = static_cast<char>(text.front() - 'a' + 'A');
  // Words in quotes end with their own mark.
  const std::string_view said = std::string_view(text).substr(0, text.find_last_not_of('"') + 1);
  if (said.empty() || std::string_view(".!?").find(said.back()) == std::string_view::npos)
    text += '.';
  return text;
}

}  // namespace engram::speech
