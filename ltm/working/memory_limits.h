// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>

#include "ltm/core/time.h"
#include "ltm/memory/memory_id.h"

namespace engram::ltm {

/// The bounds of a part of the working memory. Empty: no bound.
struct MemoryLimits {
  std::optional<size_t> snapshots;
  /// What snapshots and entities take in RAM: HeldSnapshot::ram_bytes() of each snapshot, and
  /// kEntityOverhead for each entity.
  std::optional<size_t> bytes;
  std::optional<Duration> age;  ///< The time since arrival.

  /// Errors: kInvalidArgument where a bound is not more than zero.
  [[nodiscard]] Status validate() const;
};

/// The limits of everything below an ID: a memory, a segment or an entity.
struct SegmentLimits {
  MemoryId segment;
  MemoryLimits limits;
};

/// The memory of a snapshot besides its values. Unit: bytes.
inline constexpr size_t kSnapshotOverhead = 512;

/// The memory of an entity besides its snapshots: its names, its place in indices, and the first
/// block of its history. Unit: bytes.
inline constexpr size_t kEntityOverhead = 1536;

}  // namespace engram::ltm
