// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "server/behavior_tree/skill_node.h"

namespace engram::behavior_tree {

/// Makes a type of node of each skill that the memory knows now, with its parameters as ports, and
/// the type `Skill`, which executes any. The skill `arm/wave` is the node `arm_wave`.
/// Returns the names of these types. What a provider registers later is reached by `Skill`.
/// Errors: kAlreadyExists if the factory has a node of that name; those of skills::list_skills.
/// Threading: one thread. Owns: nothing of the memory, which must outlive the trees.
Result<std::vector<std::string>> register_skills(BT::BehaviorTreeFactory& factory, Memory& memory,
                                                 const SkillNodeOptions& options = {});

}  // namespace engram::behavior_tree
