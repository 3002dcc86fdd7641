// SPDX-License-Identifier: Apache-2.0
#include "server/skills/skill_records.h"

#include <algorithm>

namespace engram::skills {

void SkillRecords::note(const ltm::MemoryId& entity, Time time) {
  Time& last = last_[entity];
  last = std::max(last, time);
}

Time SkillRecords::last_time(const ltm::MemoryId& entity) const {
  const auto found = last_.find(entity);
  return found == last_.end() ? Time{} : found->second;
}

Time SkillRecords::next_time(const ltm::MemoryId& entity) {
  Time& last = last_[entity];
  last = std::max(clock_(), last + Duration(1));
  return last;
}

Result<ltm::MemoryId> SkillRecords::commit(const ltm::MemoryId& entity, Time time,
                                           idf::Data value) {
  ltm::Instance instance{std::move(value), {.created = time, .sent = time, .provider = "skills"}};
  ENGRAM_RETURN_IF_ERROR(memory_.commit({{{entity, time, {std::move(instance)}}}}, durability_));
  return entity.at(time).instance(0);
}

Result<ltm::MemoryId> SkillRecords::add(const SkillName& name, const ::skill::Executable& value) {
  const ltm::MemoryId entity = executable_id(name);
  return commit(entity, next_time(entity), value.to_idf());
}

Result<ltm::MemoryId> SkillRecords::add(const SkillName& name, const ::skill::Refusal& value) {
  const ltm::MemoryId entity = refusal_id(name);
  return commit(entity, next_time(entity), value.to_idf());
}

Result<ltm::MemoryId> SkillRecords::add_request(std::string_view requester, const SkillName& name,
                                                const ::skill::ExecutionRequest& value) {
  const ltm::MemoryId entity = request_id(requester, name.skill);
  return commit(entity, next_time(entity), value.to_idf());
}

Result<ltm::MemoryId> SkillRecords::add(const SkillName& name, ::skill::Event event) {
  const ltm::MemoryId entity = event_id(name);
  const Time time = next_time(entity);
  if (event.stage == ::skill::Stage::STARTED) {
    event.started = time;
    event.running.push_back(time);
  }
  if (event.stage == ::skill::Stage::ENDED) event.ended = time;
  return commit(entity, time, event.to_idf());
}

}  // namespace engram::skills
