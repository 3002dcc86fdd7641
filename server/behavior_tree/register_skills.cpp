// SPDX-License-Identifier: Apache-2.0
#include "server/behavior_tree/register_skills.h"

#include <algorithm>
#include <cctype>

namespace engram::behavior_tree {

namespace {

/// A name as it may be a tag of XML. Bytes of UTF-8 may.
std::string node_name(std::string skill) {
  std::ranges::replace_if(
      skill,
      [](char c) {
        const auto byte = static_cast<unsigned char>(c);
        return byte < 0x80 && std::isalnum(byte) == 0 && c != '_' && c != '-';
      },
      '_');
  return skill;
}

Status register_one(BT::BehaviorTreeFactory& factory, const std::string& node, Memory& memory,
                    const std::optional<NodeSkill>& skill, const SkillNodeOptions& options) {
  const auto build = [&memory, skill, options](const std::string& name,
                                               const BT::NodeConfiguration& config) {
    return std::make_unique<SkillNode>(name, config, memory, skill, options);
  };
  try {
    factory.registerBuilder(BT::CreateManifest<SkillNode>(node, SkillNode::ports_of(skill)), build);
  } catch (const BT::BehaviorTreeException& error) {
    return already_exists("skill '{}' as the node '{}': {}", skill ? skill->name : "", node,
                          error.what());
  }
  return {};
}

}  // namespace

Result<std::vector<std::string>> register_skills(BT::BehaviorTreeFactory& factory, Memory& memory,
                                                 const SkillNodeOptions& options) {
  ENGRAM_ASSIGN_OR_RETURN(const auto known, skills::list_skills(memory));
  std::vector<std::string> nodes = {"Skill"};
  ENGRAM_RETURN_IF_ERROR(register_one(factory, nodes.front(), memory, std::nullopt, options));
  for (const auto& [id, executable] : known) {
    const auto& names = id.entity().names();
    const std::string skill = names[2] + "/" + names[3];
    nodes.push_back(node_name(skill));
    ENGRAM_RETURN_IF_ERROR(register_one(
        factory, nodes.back(), memory,
        NodeSkill{skill, executable.parameters.value_or(std::vector<::skill::Parameter>())},
        options));
  }
  return nodes;
}

}  // namespace engram::behavior_tree
