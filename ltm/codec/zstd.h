// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "ltm/core/status.h"

namespace engram::ltm {

/// Compresses `bytes` into a Zstandard frame, which contains its own size.
[[nodiscard]] std::vector<std::byte> compress_zstd(std::span<const std::byte> bytes, int level = 3);

/// Appends a Zstandard frame of bytes that hardly repeat but have many small values, as residuals
/// do. It relies on entropy coding and is about three times as fast as level 1. If the frame has a
/// fifth of the bytes or fewer, a second frame is made that also uses repetitions, and the smaller
/// one is kept.
void append_residuals(std::span<const std::byte> bytes, std::vector<std::byte>& out);

/// The content size that a frame announces, read before anything is allocated.
/// Errors: kDataLoss if the frame announces no size, more than `max_size`, or more than it can
/// contain.
Result<size_t> zstd_content_size(std::span<const std::byte> bytes, size_t max_size);

/// Decompresses a frame into `out`. Safe on hostile bytes.
/// Errors: kDataLoss, also if the frame contains more or fewer bytes than `out`.
Status decompress_zstd(std::span<const std::byte> bytes, std::span<std::byte> out);

/// Decompresses a frame. Safe on hostile bytes: nothing is allocated beyond `max_size`.
/// Errors: kDataLoss.
Result<std::vector<std::byte>> decompress_zstd(std::span<const std::byte> bytes, size_t max_size);

}  // namespace engram::ltm
