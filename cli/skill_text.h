// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "reports/plain/output.h"
#include "server/skills/skill_call.h"

namespace engram::cli {

/// Skills, what became of them and why, as lines for people and as JSON.

[[nodiscard]] std::string skills_text(
    const std::vector<std::pair<ltm::MemoryId, ::skill::Executable>>& skills);
[[nodiscard]] reports::Json skill_json(const ltm::MemoryId& id, const ::skill::Executable& skill);

[[nodiscard]] std::string skill_now_text(const skills::SkillNow& now);
[[nodiscard]] reports::Json skill_now_json(const skills::SkillNow& now);

[[nodiscard]] std::string event_text(const ::skill::Event& event);
[[nodiscard]] reports::Json event_json(const ::skill::Event& event);
[[nodiscard]] reports::Json refusal_json(const ::skill::Refusal& refusal);
[[nodiscard]] std::string refusal_text(const ::skill::Refusal& refusal);

/// "success", "failure", "stop", "lost" or "running".
[[nodiscard]] std::string outcome_word(::skill::Outcome outcome);

}  // namespace engram::cli
