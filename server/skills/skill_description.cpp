// SPDX-License-Identifier: Apache-2.0
#include "server/skills/skill_description.h"

#include "ltm/skills/skill_ids.h"

namespace engram::skills {

namespace {

/// A parameter that a condition names must be there, or it would never be met.
Status check_parameters(const ConfigValue& value, const SkillDescription& skill,
                        const Condition& condition, bool may_name) {
  for (const std::string& name : parameters_in(condition)) {
    if (!may_name)
      return value.error(fmt::format(
          "found ${}: what starts a skill has no parameters yet; it may bind some", name));
    if (skill.parameters.find(name) == nullptr)
      return value.error(fmt::format("found ${}, but there is no parameter '{}'", name, name));
  }
  for (const ConditionLeaf* leaf : leaves_of(condition)) {
    if (leaf->binds.empty()) continue;
    const SkillParameter* bound = skill.parameters.find(leaf->binds);
    if (bound == nullptr || bound->type.kind() != idf::TypeKind::kMemoryLink)
      return value.error(
          fmt::format("binds '{}', needs the name of a parameter that is a link", leaf->binds));
    if (may_name)
      return value.error(
          "found 'binds', which only 'when' may have: the others are asked when "
          "the parameters are known");
  }
  return {};
}

Status read_conditions(const ConfigValue& value, SkillDescription& skill) {
  ENGRAM_ASSIGN_OR_RETURN(ConfigMap map, value.map());
  for (const auto& [key, condition] : {std::pair{"pre", &skill.pre},
                                       {"hold", &skill.hold},
                                       {"post", &skill.post},
                                       {"when", &skill.when}}) {
    const auto written = map.find(key);
    if (!written) continue;
    ENGRAM_ASSIGN_OR_RETURN(*condition, read_condition(*written));
    ENGRAM_RETURN_IF_ERROR(check_parameters(*written, skill, *condition, condition != &skill.when));
  }
  ENGRAM_RETURN_IF_ERROR(map.read("post_within", skill.post_within, &ConfigValue::duration));
  return map.finish();
}

Status read_resources(const ConfigValue& value, SkillDescription& skill) {
  ENGRAM_ASSIGN_OR_RETURN(const auto names, value.list());
  for (const ConfigValue& name : names) {
    ENGRAM_ASSIGN_OR_RETURN(std::string text, name.text());
    if (const size_t at = text.find('$'); at != std::string::npos) {
      const std::string parameter = text.substr(at + 1);
      if (skill.parameters.find(parameter) == nullptr)
        return name.error(
            fmt::format("found ${}, but there is no parameter '{}'", parameter, parameter));
    }
    skill.resources.push_back(std::move(text));
  }
  return {};
}

}  // namespace

Result<SkillDescription> SkillDescription::parse(std::string_view yaml) {
  if (yaml.size() > kMaxBytes)
    return invalid_argument("skill: found a description of {} bytes, needs at most {}", yaml.size(),
                            kMaxBytes);
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue file, ConfigValue::parse(yaml, "skill"));
  ENGRAM_ASSIGN_OR_RETURN(ConfigMap map, file.map());
  SkillDescription skill{.text = std::string(yaml)};
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue name, map.require("name"));
  ENGRAM_ASSIGN_OR_RETURN(skill.name, name.text());
  if (const Status status = check_name("skill", skill.name); !status.ok())
    return name.error(status);
  ENGRAM_RETURN_IF_ERROR(map.read("doc", skill.doc, &ConfigValue::text));
  ENGRAM_RETURN_IF_ERROR(map.read("version", skill.version, &ConfigValue::text));
  if (const auto parameters = map.find("parameters")) {
    ENGRAM_ASSIGN_OR_RETURN(skill.parameters, ParameterSet::read(*parameters));
  }
  if (const auto conditions = map.find("conditions"))
    ENGRAM_RETURN_IF_ERROR(read_conditions(*conditions, skill));
  if (const auto resources = map.find("resources"))
    ENGRAM_RETURN_IF_ERROR(read_resources(*resources, skill));
  if (const auto count = map.find("max_running")) {
    constexpr int64_t kMaxRunning = 1000;
    ENGRAM_ASSIGN_OR_RETURN(const int64_t number, count->integer());
    if (number < 1 || number > kMaxRunning)
      return count->error(fmt::format("found {}, needs 1 to {}", number, kMaxRunning));
    skill.max_running = static_cast<int>(number);
  }
  ENGRAM_RETURN_IF_ERROR(map.read("timeout", skill.timeout, &ConfigValue::duration));
  ENGRAM_RETURN_IF_ERROR(map.read("stops_within", skill.stops_within, &ConfigValue::duration));
  ENGRAM_RETURN_IF_ERROR(map.finish());
  return skill;
}

}  // namespace engram::skills
