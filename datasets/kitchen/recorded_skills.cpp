// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/recorded_skills.h"

#include <array>

#include "ltm/core/check.h"
#include "ltm/idf/json.h"

namespace engram::datasets::kitchen {

namespace {

struct RecordedSkill {
  const char* name;
  const char* doc;
  bool has_surface;
  bool has_hand;
};

constexpr std::array kSkills = {
    RecordedSkill{"look", "Turns the head to an object.", false, false},
    RecordedSkill{"navigate", "Drives to where a hand reaches an object or its place.", true,
                  false},
    RecordedSkill{"pick", "Grasps an object and lifts it.", true, true},
    RecordedSkill{"place", "Puts what a hand holds on a surface.", true, true}};

}  // namespace

std::vector<std::pair<std::string, ::skill::Executable>> recorded_skills() {
  std::vector<std::pair<std::string, ::skill::Executable>> skills;
  for (const RecordedSkill& skill : kSkills) {
    ::skill::Executable executable;
    std::vector<::skill::Parameter> parameters;
    std::string text = fmt::format("name: {}\ndoc: {}\nparameters:\n", skill.name, skill.doc);
    const auto has = [&](const char* name, const char* type, const char* described) {
      ::skill::Parameter parameter;
      parameter.name = name;
      parameter.type = type;
      parameters.push_back(std::move(parameter));
      text += fmt::format("  {}: {}\n", name, described);
    };
    has("object", "link", "link");
    if (skill.has_surface) has("surface", "link", "link");
    if (skill.has_hand) has("hand", "string", "{type: string, choices: [left, right]}");
    executable.description = std::move(text);
    executable.doc = skill.doc;
    executable.version = "1";
    executable.parameters = std::move(parameters);
    executable.is_available = true;
    executable.is_enabled = true;
    skills.emplace_back(skill.name, std::move(executable));
  }
  return skills;
}

::skill::ExecutionRequest recorded_request(const std::string& skill, const ltm::MemoryId& object,
                                           const std::optional<ltm::MemoryId>& surface,
                                           const std::string& hand, const ltm::MemoryId& plan) {
  idf::Dict parameters{{"object", object.to_string()}};
  if (surface) parameters.set("surface", surface->to_string());
  if (!hand.empty()) parameters.set("hand", hand);
  const auto json = idf::to_json_text(parameters);
  ENGRAM_CHECK(json.ok(), "{}", json.status().message());
  ::skill::ExecutionRequest request;
  request.skill = "robot/" + skill;
  request.parameters = *json;
  request.causes = {plan};
  return request;
}

}  // namespace engram::datasets::kitchen
