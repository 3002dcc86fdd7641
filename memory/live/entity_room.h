// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "ltm/core/mutex.h"
#include "ltm/memory/commit.h"
#include "ltm/recall/recorded_entities.h"
#include "ltm/working/working_memory.h"

namespace engram::memory {

/// Refuses entities beyond the max that one memory may know, in working memory and in its store.
///
/// How many are known is counted exactly only where that decides: it visits all of them. New ones
/// are then added to what was counted, so it is counted again only if that says there is no room,
/// because others may have been forgotten, and at most once a second.
///
/// Threading: thread-safe.
class EntityRoom {
 public:
  /// `memory` and `recorded` must outlive it. `name` is the memory's, for errors.
  EntityRoom(std::string name, size_t max_entities, const ltm::WorkingMemory& memory,
             const ltm::RecordedEntities& recorded)
      : name_(std::move(name)), max_entities_(max_entities), memory_(memory), recorded_(recorded) {}

  /// Whether the entities of a commit are known, or may become so.
  /// Errors: kResourceExhausted naming the first one without room.
  Status admit(const ltm::Commit& commit);

  /// How often all known entities were visited.
  [[nodiscard]] uint64_t counts() const;

 private:
  [[nodiscard]] size_t count() const;

  const std::string name_;
  const size_t max_entities_;
  const ltm::WorkingMemory& memory_;
  const ltm::RecordedEntities& recorded_;

  mutable Mutex mutex_;
  /// An upper bound, once it was counted; empty while the sum of both tells enough.
  std::optional<size_t> known_ ENGRAM_GUARDED_BY(mutex_);
  std::chrono::steady_clock::time_point counted_at_ ENGRAM_GUARDED_BY(mutex_);
  uint64_t counts_ ENGRAM_GUARDED_BY(mutex_) = 0;
};

}  // namespace engram::memory
