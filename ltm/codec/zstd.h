// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "ltm/core/status.h"

namespace engram::ltm {

/// Zstandard frame of `bytes`, which carries its own size.
[[nodiscard]] std::vector<std::byte> compress_zstd(std::span<const std::byte> bytes, int level = 3);

/// A Zstandard frame of bytes in which hardly anything repeats but small values are frequent, as
/// in residuals: entropy coding first of all, about three times as fast as level 1. Where that
/// makes a fifth of the bytes or less, repetitions are looked for as well, and the smaller frame
/// wins.
[[nodiscard]] std::vector<std::byte> compress_residuals(std::span<const std::byte> bytes);

/// Safe on hostile bytes: nothing is allocated beyond `max_size`.
/// Errors: kDataLoss.
Result<std::vector<std::byte>> decompress_zstd(std::span<const std::byte> bytes, size_t max_size);

}  // namespace engram::ltm
