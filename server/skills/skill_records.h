// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <unordered_map>

#include "ltm/skills/skill_ids.h"
#include "ltm/skills/skill_types.h"
#include "memory/memory.h"

namespace engram::skills {

/// Writes what becomes of skills into the memory. With CommitDurability::kJournal everything
/// survives a killed process before the call returns, so that what follows from it (a robot that
/// moves) is never without its cause.
///
/// Time: snapshots of one entity have increasing times, whatever the clock does.
/// Threading: one thread.
class SkillRecords {
 public:
  /// `memory` must outlive it. `clock` gives the times of snapshots.
  SkillRecords(Memory& memory, Clock clock, CommitDurability durability)
      : memory_(memory), clock_(std::move(clock)), durability_(durability) {}

  /// They return the instance that was committed, for links.
  /// Errors: those of Memory::commit.
  Result<ltm::MemoryId> add(const SkillName& name, const ::skill::Executable& value);
  Result<ltm::MemoryId> add(const SkillName& name, const ::skill::Refusal& value);
  Result<ltm::MemoryId> add_request(std::string_view requester, const SkillName& name,
                                    const ::skill::ExecutionRequest& value);
  /// Sets the times of the event: `started` of one that begins, `ended` of one that ends.
  Result<ltm::MemoryId> add(const SkillName& name, ::skill::Event event);

  /// Snapshots of an entity up to this time are there already.
  void note(const ltm::MemoryId& entity, Time time);
  /// The time of the last snapshot of an entity that was noted, or that was to be added.
  [[nodiscard]] Time last_time(const ltm::MemoryId& entity) const;

 private:
  Time next_time(const ltm::MemoryId& entity);
  Result<ltm::MemoryId> commit(const ltm::MemoryId& entity, Time time, idf::Data value);

  Memory& memory_;
  const Clock clock_;
  const CommitDurability durability_;
  std::unordered_map<ltm::MemoryId, Time> last_;
};

}  // namespace engram::skills
