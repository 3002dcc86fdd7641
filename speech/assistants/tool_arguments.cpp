// SPDX-License-Identifier: Apache-2.0
#include "speech/assistants/tool_arguments.h"

#include <cmath>

namespace engram::speech {

const ToolJson* ToolArguments::find(const std::string& name) {
  known_.insert(name);
  if (!arguments_.is_object()) return nullptr;
  const auto found = arguments_.find(name);
  // Assistants write null for what they leave out.
  return found == arguments_.end() || found->is_null() ? nullptr : &*found;
}

Status ToolArguments::wrong(const std::string& name, const ToolJson& found,
                            std::string_view needed) {
  constexpr size_t kShown = 80;
  std::string text = found.dump(-1, ' ', true, ToolJson::error_handler_t::replace);
  if (text.size() > kShown) text = text.substr(0, kShown) + "...";
  return invalid_argument("argument '{}': found {}, needs {}", name, text, needed);
}

Result<std::string> ToolArguments::text(const std::string& name) {
  const ToolJson* found = find(name);
  if (found == nullptr) return invalid_argument("argument '{}' is missing, needs a text", name);
  if (!found->is_string()) return wrong(name, *found, "a text");
  return found->get<std::string>();
}

Result<std::string> ToolArguments::text_or(const std::string& name, const std::string& otherwise) {
  return find(name) == nullptr ? otherwise : text(name);
}

Result<double> ToolArguments::number(const std::string& name) {
  const ToolJson* found = find(name);
  if (found == nullptr) return invalid_argument("argument '{}' is missing, needs a number", name);
  if (!found->is_number() || !std::isfinite(found->get<double>()))
    return wrong(name, *found, "a finite number");
  return found->get<double>();
}

Result<double> ToolArguments::number_or(const std::string& name, double otherwise, double min,
                                        double max) {
  const ToolJson* found = find(name);
  if (found == nullptr) return otherwise;
  ENGRAM_ASSIGN_OR_RETURN(const double value, number(name));
  if (value < min || value > max)
    return wrong(name, *found, fmt::format("a number from {} to {}", min, max));
  return value;
}

Result<size_t> ToolArguments::count_or(const std::string& name, size_t otherwise, size_t max) {
  const ToolJson* found = find(name);
  if (found == nullptr) return otherwise;
  if (!found->is_number_unsigned() || found->get<uint64_t>() < 1 || found->get<uint64_t>() > max)
    return wrong(name, *found, fmt::format("an integer from 1 to {}", max));
  return found->get<size_t>();
}

Result<std::optional<Time>> ToolArguments::time(const std::string& name) {
  if (find(name) == nullptr) return std::optional<Time>();
  ENGRAM_ASSIGN_OR_RETURN(const std::string given, text(name));
  const auto time = parse_time(given);
  if (!time.ok()) return invalid_argument("argument '{}': {}", name, time.status().message());
  return std::optional(*time);
}

Result<ltm::MemoryId> ToolArguments::id(const std::string& name) {
  ENGRAM_ASSIGN_OR_RETURN(const std::string given, text(name));
  const auto id = ltm::MemoryId::parse(given);
  if (!id.ok()) return invalid_argument("argument '{}': {}", name, id.status().message());
  if (!id->has_entity())
    return invalid_argument("argument '{}': found '{}', needs the ID of an entity or of a snapshot",
                            name, id->printable());
  return *id;
}

Status ToolArguments::finish() const {
  if (arguments_.is_null()) return {};
  if (!arguments_.is_object())
    return invalid_argument("arguments: found {}, needs an object", arguments_.type_name());
  for (const auto& [name, value] : arguments_.items())
    if (!known_.contains(name)) {
      std::string names;
      for (const std::string& known : known_) names += (names.empty() ? "" : ", ") + known;
      return invalid_argument("argument '{}' is unknown; there are {}", name, names);
    }
  return {};
}

}  // namespace engram::speech
