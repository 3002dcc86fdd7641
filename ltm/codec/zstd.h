// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "ltm/core/status.h"

namespace engram::ltm {

/// Zstandard frame of `bytes`, which carries its own size.
[[nodiscard]] std::vector<std::byte> compress_zstd(std::span<const std::byte> bytes, int level = 3);

/// Appends a Zstandard frame of bytes in which hardly anything repeats but small values are
/// frequent, as in residuals: entropy coding first of all, about three times as fast as level 1.
/// Where that makes a fifth of the bytes or less, repetitions are looked for as well, and the
/// smaller frame wins.
void append_residuals(std::span<const std::byte> bytes, std::vector<std::byte>& out);

/// How many bytes a frame says it holds, before anything is allocated for them.
/// Errors: kDataLoss where it says nothing, more than `max_size`, or more than it can hold.
Result<size_t> zstd_content_size(std::span<const std::byte> bytes, size_t max_size);

/// Fills `out`. Safe on hostile bytes.
/// Errors: kDataLoss, also where the frame holds more or fewer bytes.
Status decompress_zstd(std::span<const std::byte> bytes, std::span<std::byte> out);

/// Safe on hostile bytes: nothing is allocated beyond `max_size`.
/// Errors: kDataLoss.
Result<std::vector<std::byte>> decompress_zstd(std::span<const std::byte> bytes, size_t max_size);

}  // namespace engram::ltm
