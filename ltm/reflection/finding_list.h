// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: what the looks found.

#include <map>
#include <utility>
#include <vector>

#include "ltm/reflection/reflection.h"

namespace engram::ltm {

/// Collects findings. Those of one kind, entity and member that follow each other closely become
/// one, and of each kind and entity a bounded number is told.
///
/// Threading: one thread.
class FindingList {
 public:
  /// Max number of findings of one kind and entity.
  static constexpr size_t kMaxTold = 200;

  /// Adds a finding. `close` is how far apart findings are that become one.
  void add(ReflectionFinding finding, Duration close = std::chrono::seconds(1));

  /// Whether anything of a kind was found of an entity within a span.
  [[nodiscard]] bool has(ReflectionKind kind, const MemoryId& entity, Time first, Time last) const;

  /// Faults first, then by entity, time and kind.
  [[nodiscard]] std::vector<ReflectionFinding> take(uint64_t& untold);

 private:
  using Key = std::pair<MemoryId, ReflectionKind>;

  std::map<Key, std::vector<ReflectionFinding>> found_;
  uint64_t untold_ = 0;
};

}  // namespace engram::ltm
