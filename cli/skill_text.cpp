// SPDX-License-Identifier: Apache-2.0
#include "cli/skill_text.h"

#include <nlohmann/json.hpp>

#include "ltm/core/printable.h"

namespace engram::cli {

namespace {

using reports::Json;

Json links_json(const std::vector<ltm::MemoryId>& links) {
  Json list = Json::array();
  for (const ltm::MemoryId& link : links) list.push_back(link.to_string());
  return list;
}

/// What a provider or a requester wrote as JSON; a text where it is none.
Json written_json(const std::string& text) {
  if (text.empty()) return nullptr;
  Json json = Json::parse(text, nullptr, false);
  return json.is_discarded() ? Json(text) : json;
}

std::string state_of(const ::skill::Executable& skill) {
  if (!skill.is_enabled.value_or(true)) return "disabled";
  return skill.is_available.value_or(false) ? "ready" : "provider is away";
}

std::string name_of_skill(const ltm::MemoryId& id) {
  return printable(id.names()[2] + "/" + id.names()[3]);
}

std::string parameters_text(const ::skill::Executable& skill) {
  std::string text;
  for (const ::skill::Parameter& parameter :
       skill.parameters.value_or(std::vector<::skill::Parameter>())) {
    text += fmt::format("  {}: {}{}", parameter.name, parameter.type,
                        parameter.unit.empty() ? "" : " in " + parameter.unit);
    text += parameter.default_json ? fmt::format(", default {}", *parameter.default_json)
                                   : std::string(", needed");
    text += (parameter.doc.empty() ? "" : ". " + parameter.doc) + "\n";
  }
  return text.empty() ? "" : "parameters\n" + printable_lines(text);
}

}  // namespace

std::string outcome_word(::skill::Outcome outcome) {
  switch (outcome) {
    case ::skill::Outcome::SUCCESS:
      return "success";
    case ::skill::Outcome::FAILURE:
      return "failure";
    case ::skill::Outcome::STOP:
      return "stop";
    case ::skill::Outcome::LOST:
      return "lost";
    case ::skill::Outcome::RUNNING:
      break;
  }
  return "running";
}

std::string skills_text(const std::vector<std::pair<ltm::MemoryId, ::skill::Executable>>& skills) {
  if (skills.empty()) return "no skills are known";
  std::string text;
  size_t width = 0;
  for (const auto& [id, skill] : skills) width = std::max(width, name_of_skill(id).size());
  for (const auto& [id, skill] : skills)
    text += fmt::format("{}{:<{}}  {:<16}  {}", text.empty() ? "" : "\n", name_of_skill(id), width,
                        state_of(skill), printable(skill.doc.value_or("")));
  return text;
}

Json skill_json(const ltm::MemoryId& id, const ::skill::Executable& skill) {
  Json parameters = Json::array();
  for (const ::skill::Parameter& parameter :
       skill.parameters.value_or(std::vector<::skill::Parameter>())) {
    Json one{{"name", parameter.name}, {"type", parameter.type}, {"unit", parameter.unit}};
    if (parameter.default_json) one["default"] = written_json(*parameter.default_json);
    one["doc"] = parameter.doc;
    parameters.push_back(std::move(one));
  }
  return {{"skill", id.names()[2] + "/" + id.names()[3]},
          {"id", id.to_string()},
          {"doc", skill.doc.value_or("")},
          {"version", skill.version.value_or("")},
          {"is_available", skill.is_available.value_or(false)},
          {"is_enabled", skill.is_enabled.value_or(true)},
          {"parameters", std::move(parameters)},
          {"description", skill.description}};
}

std::string event_text(const ::skill::Event& event) {
  std::string text = printable(event.skill) + " ";
  if (event.stage == ::skill::Stage::STARTED) {
    text += "started " + printable(event.parameters);
  } else if (event.stage == ::skill::Stage::INTERMEDIATE) {
    text += "reports " + printable(event.result);
  } else {
    text += outcome_word(event.outcome);
    if (event.ended)
      text += fmt::format(" after {:.3f} s", to_seconds(*event.ended - event.started));
  }
  if (!event.reason.empty()) text += ": " + printable(event.reason);
  return text;
}

Json event_json(const ::skill::Event& event) {
  static constexpr std::array<const char*, 3> kStages{"started", "intermediate", "ended"};
  Json json{{"skill", event.skill},
            {"stage", kStages.at(static_cast<size_t>(event.stage))},
            {"outcome", outcome_word(event.outcome)},
            {"reason", event.reason},
            {"started_ns", to_ns(event.started)}};
  if (event.ended) json["ended_ns"] = to_ns(*event.ended);
  if (event.execution) json["execution"] = event.execution->to_string();
  json["request"] = event.request.to_string();
  json["executable"] = event.executable.to_string();
  json["parameters"] = written_json(event.parameters);
  json["inputs"] = links_json(event.inputs);
  json["result"] = written_json(event.result);
  json["results"] = links_json(event.results);
  json["stopped_by"] = links_json(event.stopped_by);
  return json;
}

Json refusal_json(const ::skill::Refusal& refusal) {
  return {{"skill", refusal.skill},   {"outcome", "refused"},
          {"reason", refusal.reason}, {"request", refusal.request.to_string()},
          {"unmet", refusal.unmet},   {"found", links_json(refusal.found)}};
}

std::string refusal_text(const ::skill::Refusal& refusal) {
  std::string text = printable(refusal.skill) + " refused: " + printable(refusal.reason);
  for (const ltm::MemoryId& link : refusal.found) text += "\n  found in " + link.printable();
  return text;
}

std::string skill_now_text(const skills::SkillNow& now) {
  std::string text =
      fmt::format("{} (version {}): {}", name_of_skill(now.id),
                  printable(now.executable.version.value_or("?")), state_of(now.executable));
  if (now.executable.doc && !now.executable.doc->empty())
    text += "\n" + printable(*now.executable.doc);
  if (const std::string parameters = parameters_text(now.executable); !parameters.empty())
    text += "\n" + parameters.substr(0, parameters.size() - 1);
  if (!now.conditions.empty()) text += "\nconditions";
  for (const skills::ConditionNow& condition : now.conditions) {
    text += fmt::format("\n  {}: {}: {}", condition.name, condition.is_met ? "met" : "not met",
                        printable(condition.text));
    for (const skills::Unmet& unmet : condition.unmet) {
      text += "\n    needs " + printable(unmet.to_string());
      if (unmet.where) text += "\n    in " + unmet.where->printable();
    }
  }
  for (const std::string& name : now.needs_parameters)
    text += fmt::format("\n  {}: needs parameters to be told", name);
  if (now.last_event) text += "\nlast: " + event_text(*now.last_event);
  if (now.last_refusal) text += "\nlast refusal: " + refusal_text(*now.last_refusal);
  return text;
}

Json skill_now_json(const skills::SkillNow& now) {
  Json json = skill_json(now.id, now.executable);
  json["conditions"] = Json::array();
  for (const skills::ConditionNow& condition : now.conditions) {
    Json unmet = Json::array();
    for (const skills::Unmet& one : condition.unmet) {
      Json told{{"condition", one.condition}, {"found", one.found}};
      if (one.where) told["in"] = one.where->to_string();
      unmet.push_back(std::move(told));
    }
    json["conditions"].push_back({{"name", condition.name},
                                  {"text", condition.text},
                                  {"is_met", condition.is_met},
                                  {"unmet", std::move(unmet)}});
  }
  json["needs_parameters"] = now.needs_parameters;
  if (now.last_event) json["last_event"] = event_json(*now.last_event);
  if (now.last_refusal) json["last_refusal"] = refusal_json(*now.last_refusal);
  return json;
}

}  // namespace engram::cli
