// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/ahead_limits.h"

namespace engram::ltm {

Status AheadLimits::validate() const {
  if (all < Duration(0))
    return invalid_argument("max_ahead: found {}, needs 0s or more", to_string(all));
  for (const auto& [id, limit] : parts)
    if (limit < Duration(0))
      return invalid_argument("max_ahead of '{}': found {}, needs 0s or more", id.to_string(),
                              to_string(limit));
  return {};
}

Duration AheadLimits::of(const MemoryId& entity) const {
  Duration limit = all;
  size_t depth = 0;
  for (const auto& [id, of_part] : parts) {
    if (id.depth() < depth || !id.is_prefix_of(entity)) continue;
    depth = id.depth();
    limit = of_part;
  }
  return limit;
}

Status check_ahead(const MemoryId& entity, Time time, Time now, Duration limit) {
  // Both differences may be too large for their type.
  if (limit == AheadLimits::kNone || time <= now) return {};
  const auto ahead = static_cast<uint64_t>(to_ns(time)) - static_cast<uint64_t>(to_ns(now));
  if (ahead <= static_cast<uint64_t>(limit.count())) return {};
  return invalid_argument(
      "entity '{}': {} lies ahead of the clock, which says {}: needs at most {} (max_ahead)",
      entity.to_string(), to_string(time), to_string(now), to_string(limit));
}

}  // namespace engram::ltm
