// SPDX-License-Identifier: Apache-2.0
#include "ltm/skills/skill_ids.h"

#include "ltm/skills/skill_types.h"

namespace engram::skills {

namespace {

ltm::MemoryId skill_entity(std::string_view segment, std::string_view provider,
                           std::string_view entity) {
  auto id = ltm::MemoryId::from_names({std::string(kSkillMemory), std::string(segment),
                                       std::string(provider), std::string(entity)});
  ENGRAM_CHECK(id.ok(), "{}", id.status().message());
  return *std::move(id);
}

}  // namespace

ltm::MemoryId executable_id(const SkillName& name) {
  return skill_entity(kExecutableSegment, name.provider, name.skill);
}

ltm::MemoryId event_id(const SkillName& name) {
  return skill_entity(kEventSegment, name.provider, name.skill);
}

ltm::MemoryId refusal_id(const SkillName& name) {
  return skill_entity(kRefusalSegment, name.provider, name.skill);
}

ltm::MemoryId request_id(std::string_view requester, std::string_view skill) {
  return skill_entity(kRequestSegment, requester, skill);
}

Status check_name(std::string_view what, std::string_view name) {
  constexpr size_t kMaxNameBytes = 200;
  if (name.empty()) return invalid_argument("{}: found an empty name, needs one", what);
  if (name.size() > kMaxNameBytes)
    return invalid_argument("{}: found a name of {} bytes, needs at most {}", what, name.size(),
                            kMaxNameBytes);
  if (name.find('/') != std::string_view::npos)
    return invalid_argument("{} '{}': found a slash, needs a name without one", what, name);
  const auto id = ltm::MemoryId::from_names({std::string(name)});
  return id.ok() ? Status() : id.status().with_context(what);
}

std::vector<std::pair<ltm::MemoryId, idf::Type>> skill_types() {
  const auto segment = [](std::string_view name) {
    auto id = ltm::MemoryId::from_names({std::string(kSkillMemory), std::string(name)});
    ENGRAM_CHECK(id.ok(), "{}", id.status().message());
    return *std::move(id);
  };
  return {{segment(kExecutableSegment), ::skill::Executable::idf_type()},
          {segment(kRequestSegment), ::skill::ExecutionRequest::idf_type()},
          {segment(kEventSegment), ::skill::Event::idf_type()},
          {segment(kRefusalSegment), ::skill::Refusal::idf_type()}};
}

}  // namespace engram::skills
