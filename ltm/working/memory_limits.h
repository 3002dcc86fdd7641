// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>

#include "ltm/core/time.h"
#include "ltm/memory/memory_id.h"

namespace engram::ltm {

/// What of a part of the working memory may stay. Nothing: any number.
struct MemoryLimits {
  std::optional<size_t> snapshots;
  std::optional<size_t> bytes;  ///< Plain bytes, and kSnapshotOverhead each.
  std::optional<Duration> age;  ///< Since they arrived.

  /// Errors: kInvalidArgument where one is not more than zero.
  [[nodiscard]] Status validate() const;
};

/// The limits of all that lies below an ID: a memory, a segment or an entity.
struct SegmentLimits {
  MemoryId segment;
  MemoryLimits limits;
};

/// What a snapshot takes beside its values. Unit: bytes.
inline constexpr size_t kSnapshotOverhead = 512;

}  // namespace engram::ltm
