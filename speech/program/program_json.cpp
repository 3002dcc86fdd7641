// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/printable.h"
#include "ltm/core/utf8.h"
#include "speech/program/program.h"

namespace engram::speech {

namespace {

using Json = nlohmann::ordered_json;

Json argument_json(const Argument& argument) {
  return argument.program == nullptr ? Json(argument.text) : argument.program->to_json();
}

Result<Program> program_of(const Json& json, int depth);

Result<Argument> argument_of(const Json& json, int depth) {
  if (json.is_string()) {
    auto text = json.get<std::string>();
    if (text.empty() || text.size() > Program::kMaxTextBytes || !is_utf8(text))
      return invalid_argument("program: a text has {} bytes, needs 1 to {} of UTF-8", text.size(),
                              Program::kMaxTextBytes);
    return Argument{std::move(text), nullptr};
  }
  ENGRAM_ASSIGN_OR_RETURN(Program inner, program_of(json, depth + 1));
  return Argument{{}, std::make_shared<const Program>(std::move(inner))};
}

Status add_filters(const Json& json, int depth, Program& program) {
  if (!json.is_object() || json.size() > Program::kMaxParts)
    return invalid_argument("program: 'filters' needs an object of at most {} members",
                            Program::kMaxParts);
  for (const auto& [name, value] : json.items()) {
    const auto key = filter_named(name);
    if (!key) return invalid_argument("program: there is no filter '{}'", printable(name));
    ENGRAM_ASSIGN_OR_RETURN(Argument argument, argument_of(value, depth));
    program.filters.push_back({*key, std::move(argument)});
  }
  return {};
}

Status add_step(const Json& json, int depth, Program& program) {
  if (!json.is_string() && !(json.is_object() && json.size() == 1))
    return invalid_argument("program: a step is {}, needs a name or {{name: argument}}",
                            json.type_name());
  const std::string name = json.is_string() ? json.get<std::string>() : json.begin().key();
  const auto kind = step_named(name);
  if (!kind) return invalid_argument("program: there is no step '{}'", printable(name));
  ProgramStep step{*kind, {}};
  if (json.is_object()) {
    ENGRAM_ASSIGN_OR_RETURN(step.argument, argument_of(json.begin().value(), depth));
  }
  program.steps.push_back(std::move(step));
  return {};
}

Result<Program> program_of(const Json& json, int depth) {
  if (depth >= Program::kMaxDepth)
    return invalid_argument("program: needs at most {} programs in each other", Program::kMaxDepth);
  if (!json.is_object())
    return invalid_argument("program: found {}, needs an object", json.type_name());
  Program program;
  const auto source = json.find("source");
  if (source == json.end() || !source->is_string())
    return invalid_argument("program: needs a member 'source' that is a text");
  const auto read = source_named(source->get<std::string>());
  if (!read)
    return invalid_argument("program: there is no source '{}'",
                            printable(source->get<std::string>()));
  program.source = *read;
  if (const auto filters = json.find("filters"); filters != json.end())
    ENGRAM_RETURN_IF_ERROR(add_filters(*filters, depth, program));
  const auto steps = json.find("steps");
  if (steps == json.end()) return program;
  if (!steps->is_array() || steps->size() > Program::kMaxParts)
    return invalid_argument("program: 'steps' needs a list of at most {}", Program::kMaxParts);
  for (const Json& step : *steps) ENGRAM_RETURN_IF_ERROR(add_step(step, depth, program));
  return program;
}

}  // namespace

Result<Program> Program::from_json(const Json& json) {
  ENGRAM_ASSIGN_OR_RETURN(Program program, program_of(json, 0));
  ENGRAM_RETURN_IF_ERROR(program.validate());
  return program;
}

Json Program::to_json() const {
  Json json{{"source", name_of(source)}};
  Json filter_members = Json::object();
  for (const ProgramFilter& filter : filters)
    filter_members[std::string(name_of(filter.key))] = argument_json(filter.value);
  json["filters"] = std::move(filter_members);
  Json step_list = Json::array();
  for (const ProgramStep& step : steps)
    step_list.push_back(step.argument ? Json{{name_of(step.kind), argument_json(*step.argument)}}
                                      : Json(name_of(step.kind)));
  json["steps"] = std::move(step_list);
  return json;
}

}  // namespace engram::speech
