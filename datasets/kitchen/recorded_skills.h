// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the skills of the robot that is recorded, as the memory of skills has them.

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ltm/memory/memory_id.h"
#include "ltm/skills/skill_types.h"

namespace engram::datasets::kitchen {

/// look, navigate, pick and place: their names and descriptions.
[[nodiscard]] std::vector<std::pair<std::string, ::skill::Executable>> recorded_skills();

/// What the planner asks for. `surface` and `hand` (left, right or empty) where the skill has them.
[[nodiscard]] ::skill::ExecutionRequest recorded_request(
    const std::string& skill, const ltm::MemoryId& object,
    const std::optional<ltm::MemoryId>& surface, const std::string& hand,
    const ltm::MemoryId& plan);

}  // namespace engram::datasets::kitchen
