// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ltm/idf/type.h"
#include "ltm/memory/memory_id.h"

namespace engram::skills {

/// The memory of skills, and its segments.
inline constexpr std::string_view kSkillMemory = "Skill";
inline constexpr std::string_view kExecutableSegment = "Executable";
inline constexpr std::string_view kRequestSegment = "ExecutionRequest";
inline constexpr std::string_view kEventSegment = "Event";
inline constexpr std::string_view kRefusalSegment = "Refusal";

/// "PROVIDER/SKILL", as requests name a skill.
struct SkillName {
  std::string provider;
  std::string skill;

  [[nodiscard]] std::string to_string() const { return provider + "/" + skill; }
  friend auto operator<=>(const SkillName&, const SkillName&) = default;
};

/// The entities of a skill. Names that come from outside must be valid names of an ID (checked by
/// check_name()).
[[nodiscard]] ltm::MemoryId executable_id(const SkillName& name);
[[nodiscard]] ltm::MemoryId event_id(const SkillName& name);
[[nodiscard]] ltm::MemoryId refusal_id(const SkillName& name);
/// Where a requester asks for a skill.
[[nodiscard]] ltm::MemoryId request_id(std::string_view requester, std::string_view skill);

/// Errors: kInvalidArgument if it is empty, longer than 200 bytes, not UTF-8, or has a slash.
[[nodiscard]] Status check_name(std::string_view what, std::string_view name);

/// The core segments of the skill memory with the types of their values.
[[nodiscard]] std::vector<std::pair<ltm::MemoryId, idf::Type>> skill_types();

}  // namespace engram::skills
