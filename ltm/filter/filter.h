// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "ltm/memory/snapshot.h"

namespace engram::ltm {

/// Says which snapshots of one entity are worth keeping.
///
/// Threading: one thread; each entity owns its own filter.
/// Complexity: at most O(size of the snapshot).
class Filter {
 public:
  virtual ~Filter() = default;

  /// "frequency", ...: the reason that counters give for what it drops.
  [[nodiscard]] virtual std::string_view name() const = 0;

  /// Says whether this snapshot is worth keeping, and remembers it if so.
  [[nodiscard]] virtual bool keeps(const Snapshot& snapshot) = 0;
};

}  // namespace engram::ltm
