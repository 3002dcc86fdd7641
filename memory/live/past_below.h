// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>

#include "ltm/memory/commit.h"
#include "ltm/memory/segment_types.h"
#include "ltm/recall/answer.h"
#include "ltm/recall/known_past.h"
#include "ltm/working/working_memory.h"

namespace engram::memory {

/// Who is told of what happens in a past that goes on by itself.
struct PastListener {
  /// Whether anybody wants to be told of an entity. What nobody wants is not read.
  std::function<bool(const ltm::MemoryId& entity)> is_wanted;
  std::function<void(std::span<const ltm::SharedSnapshot> snapshots)> publish;
};

/// What lies below working memory in place of a store that is recorded to: a past that nobody adds
/// to. What is committed stays in working memory, and ends with it.
///
/// Threading: thread-safe.
class PastBelow {
 public:
  virtual ~PastBelow() = default;

  /// The clock of the memory above it.
  [[nodiscard]] virtual Clock clock() const = 0;

  /// The types of the segments.
  [[nodiscard]] virtual ltm::SegmentTypes types() const = 0;

  /// Makes what queries are answered from: this past under `above`, called `name` in messages.
  /// Called once. Both outlive the result; until detach() this object may use `above`.
  virtual std::unique_ptr<ltm::KnownPast> attach(const std::string& name,
                                                 ltm::WorkingMemory& above) = 0;

  /// Called before `above` goes.
  virtual void detach() = 0;

  /// Sets who is told; empty functions: nobody. Afterwards nobody is told by the functions before.
  virtual void tell(PastListener listener) = 0;

  /// Called ahead of each commit; an error refuses it.
  virtual Status check(const ltm::Commit& commit) = 0;

  /// Called after each commit. An error refuses it; nothing of it is in working memory then.
  virtual Status admitted(const ltm::Admission& admission) = 0;

  /// Called with each answer before it is given out.
  virtual void answered(const ltm::Answer& answer) = 0;
};

}  // namespace engram::memory
