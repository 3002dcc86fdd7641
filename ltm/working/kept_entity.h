// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <vector>

#include "ltm/working/entity_history.h"
#include "ltm/working/memory_limits.h"

namespace engram::ltm {

struct LimitedPart;

/// An entity of a working memory: its snapshots, and how much they are needed.
///
/// Threading: as WorkingMemory locks it; `reads` from any thread.
struct KeptEntity {
  /// The bound of entities that are remembered to link to one entity.
  static constexpr size_t kMaxLinkedBy = 16;

  explicit KeptEntity(MemoryId entity) : id(std::move(entity)) {}

  MemoryId id;
  EntityHistory history;
  Time last_queued = Time::min();

  /// A part of the memory whose limits apply to the entity, and the entity's index among its
  /// members. An entity is a member as long as one of its snapshots stays.
  struct Membership {
    LimitedPart* part = nullptr;
    size_t index = 0;
  };
  std::vector<Membership> parts;
  bool is_member = false;

  std::vector<KeptEntity*> links;      ///< The entities that its newest snapshot links to.
  std::vector<KeptEntity*> linked_by;  ///< The entities that link to it, at most kMaxLinkedBy.

  mutable std::atomic<uint32_t> reads{0};  ///< Reads that are not yet in `read_rate`.
  double read_rate = 0;                    ///< The sum of reads, each halved per half-life.
  Time rated{};                            ///< The time of `read_rate`.

  /// The sum of reads until now; a read counts half after each half-life.
  double read_rate_at(Time now, Duration half_life);

  /// Sets the entities that its newest snapshot links to: each once, without itself.
  void link_to(std::vector<KeptEntity*> targets);

  /// Removes all links from and to the entity.
  void unlink();
};

/// A part of the memory with limits: all of it, a memory, a segment or an entity.
struct LimitedPart {
  MemoryId id;
  MemoryLimits limits;
  size_t snapshots = 0;  ///< Snapshots that stay.
  size_t bytes = 0;      ///< Bytes of these snapshots.
  std::vector<KeptEntity*> members;

  [[nodiscard]] bool is_exceeded() const {
    return (limits.snapshots && snapshots > *limits.snapshots) ||
           (limits.bytes && bytes > *limits.bytes);
  }
};

/// The gain if the oldest snapshot that stays leaves. Unit: byte seconds per read; reads of
/// entities that link to it count half.
[[nodiscard]] double leaving_gain(KeptEntity& entity, Time now, Duration read_half_life);

}  // namespace engram::ltm
