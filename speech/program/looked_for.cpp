// SPDX-License-Identifier: Apache-2.0
#include "speech/program/looked_for.h"

#include <algorithm>

#include "ltm/core/printable.h"

namespace engram::speech {

namespace {

/// A time of a program in words; the time that a program finds is described by that program.
std::string time_words(const Argument& argument) {
  if (argument.program != nullptr) return looked_for(*argument.program);
  std::string words = printable(argument.text);
  if (words.starts_with("now-")) return words.substr(4) + " ago";
  if (words.starts_with("last:")) return "the last " + words.substr(5);
  std::replace(words.begin(), words.end(), '_', ' ');
  std::replace(words.begin(), words.end(), '/', ' ');
  if (const size_t dots = words.find(".."); dots != std::string::npos)
    words = words.substr(0, dots) + " to " + words.substr(dots + 2);
  return words;
}

std::string outcome_words(const std::string& outcome) {
  if (outcome == "failure") return "that failed";
  if (outcome == "success") return "that succeeded";
  if (outcome == "stop") return "that were stopped";
  if (outcome == "problem") return "that failed or were stopped";
  if (outcome == "running") return "that are running";
  return "that were lost";
}

std::string filter_words(const ProgramFilter& filter) {
  const std::string text = printable(filter.value.text);
  switch (filter.key) {
    case FilterKey::kSkill:
      return "of " + text;
    case FilterKey::kThing:
      return "of the " + text;
    case FilterKey::kPlace:
      return "at the " + text;
    case FilterKey::kHand:
      return "with the " + text + " hand";
    case FilterKey::kOutcome:
      return outcome_words(filter.value.text);
    case FilterKey::kSpeaker:
      return "for " + text;
    case FilterKey::kText:
      return "with '" + text + "'";
    case FilterKey::kKind:
      return "that " + text;
    case FilterKey::kIsHeld:
      return filter.value.text == "yes" ? "in a hand" : "in no hand";
    case FilterKey::kVisible:
      return filter.value.text == "yes" ? "in sight" : "out of sight";
    case FilterKey::kDuring:
      return "(" + time_words(filter.value) + ")";
    case FilterKey::kAt:
      return "at " + time_words(filter.value);
    case FilterKey::kAfter:
      return "after " + time_words(filter.value);
    case FilterKey::kBefore:
      return "before " + time_words(filter.value);
  }
  return {};
}

std::string_view source_words(ProgramSource source) {
  switch (source) {
    case ProgramSource::kExecutions:
      return "executions";
    case ProgramSource::kWords:
      return "words that were said";
    case ProgramSource::kPlans:
      return "plans";
    case ProgramSource::kRefusals:
      return "requests that were refused";
    case ProgramSource::kDrives:
      return "notes of drives";
    case ProgramSource::kThings:
      return "things";
    case ProgramSource::kRobot:
      return "the place of the robot";
  }
  return {};
}

}  // namespace

std::string looked_for(const Program& program) {
  std::string text(source_words(program.source));
  for (const ProgramFilter& filter : program.filters) text += " " + filter_words(filter);
  return text;
}

}  // namespace engram::speech
