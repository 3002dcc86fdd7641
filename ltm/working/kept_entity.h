// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <vector>

#include "ltm/working/entity_history.h"
#include "ltm/working/memory_limits.h"

namespace engram::ltm {

struct LimitedPart;

/// An entity of a working memory: its snapshots, and what tells how much they are needed.
///
/// Threading: as WorkingMemory locks it; `reads` from any thread.
struct KeptEntity {
  /// Most entities that are remembered to link to one.
  static constexpr size_t kMaxLinkedBy = 16;

  explicit KeptEntity(MemoryId entity) : id(std::move(entity)) {}

  MemoryId id;
  EntityHistory history;
  Time last_queued = Time::min();

  /// The parts of the memory whose limits count for it, and its place among their members, which
  /// it has while one of its snapshots stays.
  struct Membership {
    LimitedPart* part = nullptr;
    size_t index = 0;
  };
  std::vector<Membership> parts;
  bool is_member = false;

  std::vector<KeptEntity*> links;      ///< That its newest snapshot links to.
  std::vector<KeptEntity*> linked_by;  ///< At most kMaxLinkedBy.

  mutable std::atomic<uint32_t> reads{0};  ///< That are not in `read_rate`.
  double read_rate = 0;                    ///< Reads, each counting half after the half-life.
  Time rated{};                            ///< When that was.

  /// Reads until now, older ones counting less.
  double read_rate_at(Time now, Duration half_life);

  /// From now on its newest snapshot links to these. Each once, without itself.
  void link_to(std::vector<KeptEntity*> targets);

  /// Nothing links to it and it links to nothing.
  void unlink();
};

/// A part of the memory with limits: all, a memory, a segment or an entity.
struct LimitedPart {
  MemoryId id;
  MemoryLimits limits;
  size_t snapshots = 0;  ///< That stay.
  size_t bytes = 0;      ///< Of these.
  std::vector<KeptEntity*> members;

  [[nodiscard]] bool is_exceeded() const {
    return (limits.snapshots && snapshots > *limits.snapshots) ||
           (limits.bytes && bytes > *limits.bytes);
  }
};

/// How much is gained where the oldest snapshot that stays leaves: byte seconds per read, those of
/// what links to it counting half.
[[nodiscard]] double leaving_gain(KeptEntity& entity, Time now, Duration read_half_life);

}  // namespace engram::ltm
