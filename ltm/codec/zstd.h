// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "ltm/core/status.h"

namespace engram::ltm {

/// Zstandard frame of `bytes`, which carries its own size.
[[nodiscard]] std::vector<std::byte> compress_zstd(std::span<const std::byte> bytes, int level = 3);

/// Safe on hostile bytes: nothing is allocated beyond `max_size`.
/// Errors: kDataLoss.
Result<std::vector<std::byte>> decompress_zstd(std::span<const std::byte> bytes, size_t max_size);

}  // namespace engram::ltm
