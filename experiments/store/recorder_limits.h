// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "store/stream.h"

namespace engram::experiments {

/// Bounds that no recorder on this machine can beat.
struct Limits {
  double copy_seconds = 0;   ///< To copy the stream's pixels and numbers once in memory.
  double write_seconds = 0;  ///< To write `stored_bytes` to one file and force it to the disk.
};

/// Errors: kUnavailable, kResourceExhausted if the disk fails.
Result<Limits> measure_limits(const Stream& stream, uint64_t stored_bytes,
                              const std::filesystem::path& folder);

}  // namespace engram::experiments
