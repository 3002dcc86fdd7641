// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "ltm/core/status.h"
#include "ltm/core/time.h"
#include "ltm/memory/memory_id.h"

namespace engram::ltm {

/// How far the time of a snapshot may lie ahead of the clock. One from the far future would be the
/// latest of its entity for ever, and every `last:` would end there.
///
/// Threading: const-parallel.
struct AheadLimits {
  static constexpr Duration kNone = Duration::max();  ///< For no limit.

  Duration all = std::chrono::hours(1);
  /// Limits of what lies at or below an ID. The longest ID counts.
  std::vector<std::pair<MemoryId, Duration>> parts;

  /// Errors: kInvalidArgument where a limit is negative.
  [[nodiscard]] Status validate() const;

  [[nodiscard]] Duration of(const MemoryId& entity) const;
};

/// Errors: kInvalidArgument with both times where `time` lies further ahead of `now` than `limit`.
[[nodiscard]] Status check_ahead(const MemoryId& entity, Time time, Time now, Duration limit);

}  // namespace engram::ltm
