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
  std::optional<size_t> bytes;  ///< Plain bytes, plus kSnapshotOverhead for each snapshot.
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

}  // namespace engram::ltm
