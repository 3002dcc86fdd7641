// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <list>
#include <memory>
#include <mutex>
#include <optional>

#include "ltm/recall/engine_choice.h"
#include "server/memory/working_memory.h"
#include "server/service/long_term.h"

namespace engram::server {

/// Predicts entities from what working memory and the store have of them, by whichever engine was
/// best on that past. What engines learned of an entity is kept for those that were asked about
/// last.
///
/// Threading: thread-safe; one prediction at a time.
/// Source: docs/prediction.md.
class Predictions {
 public:
  /// Both outlive it; `store` may be null.
  Predictions(const WorkingMemory& memory, LongTerm* store) : memory_(memory), store_(store) {}

  /// The state of an entity at moments after its last snapshot, in their order. `engine`: empty for
  /// the best of each.
  /// Errors: kNotFound where there is no snapshot or no such engine; kInvalidArgument where a
  /// moment is not after the last snapshot, or more than `furthest` after it.
  Result<std::vector<ltm::SnapshotResult>> predict(const ltm::MemoryId& entity,
                                                   std::span<const Time> moments,
                                                   const std::string& engine, Duration furthest);

  /// All engines, measured that far ahead, the one that answers first.
  Result<std::vector<ltm::EngineRecord>> records(const ltm::MemoryId& entity, Duration ahead);

 private:
  static constexpr size_t kMostLearned = 64;

  struct Learned {
    ltm::MemoryId entity;
    std::unique_ptr<ltm::EngineChoice> choice;
    size_t wanted = 1;
    std::optional<Time> last;
  };

  Result<Learned*> learned(const ltm::MemoryId& entity);
  Result<Learned> begun(const ltm::MemoryId& entity, const ltm::Snapshot& newest);
  Status add_new(Learned& learned);
  [[nodiscard]] std::optional<idf::Data> condition_at(const ltm::MemoryId& entity, Time time) const;

  const WorkingMemory& memory_;
  LongTerm* store_;
  std::mutex mutex_;
  std::list<Learned> learned_;  ///< The one that was asked about last in front.
};

}  // namespace engram::server
