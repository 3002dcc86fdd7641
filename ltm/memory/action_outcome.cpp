// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/action_outcome.h"

#include "ltm/core/ascii.h"

namespace engram::ltm {

std::string_view name_of(ActionOutcome outcome) {
  switch (outcome) {
    case ActionOutcome::kRunning:
      return "running";
    case ActionOutcome::kSuccess:
      return "success";
    case ActionOutcome::kFailure:
      return "failure";
    case ActionOutcome::kStop:
      return "stop";
    case ActionOutcome::kUnknown:
      break;
  }
  return "unknown";
}

ActionOutcome outcome_named(std::string name) {
  name = lower_ascii(name);
  const auto has = [&name](std::string_view part) { return name.find(part) != std::string::npos; };
  if (has("unsucc") || has("fail") || has("error") || has("abort")) return ActionOutcome::kFailure;
  if (has("succ") || has("done") || has("finish")) return ActionOutcome::kSuccess;
  if (has("stop") || has("cancel") || has("preempt")) return ActionOutcome::kStop;
  if (has("run") || has("active") || has("begun") || has("start")) return ActionOutcome::kRunning;
  return ActionOutcome::kUnknown;
}

ActionOutcome outcome_of(const idf::Data& value, std::string_view member,
                         const std::optional<idf::Type>& type) {
  if (const auto* flag = value.get_if<bool>())
    return *flag ? ActionOutcome::kSuccess : ActionOutcome::kFailure;
  if (const auto* text = value.get_if<std::string>()) return outcome_named(*text);
  const auto* number = value.get_if<int32_t>();
  if (number == nullptr || !type) return ActionOutcome::kUnknown;
  for (const idf::Member& part : type->parts()) {
    const auto* choices = part.name == member ? part.type.get_if<idf::types::IntEnum>() : nullptr;
    if (choices == nullptr) continue;
    for (const idf::EnumValue& choice : choices->values)
      if (choice.value == *number) return outcome_named(choice.name);
  }
  return ActionOutcome::kUnknown;
}

}  // namespace engram::ltm
