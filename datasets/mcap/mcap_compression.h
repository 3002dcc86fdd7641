// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "ltm/core/buffer.h"
#include "ltm/core/status.h"

namespace engram::datasets::mcap {

/// Compresses the records of a chunk: "zstd", "lz4" (frames) or "" (not at all).
/// Errors: kInvalidArgument naming what there is.
Result<std::string> compress(std::string_view compression, std::span<const std::byte> bytes);

/// Nothing is allocated for sizes that so few bytes cannot hold.
/// Errors: kDataLoss where it holds more or fewer than `size` bytes; kInvalidArgument for another
/// compression.
Result<Buffer> decompress(std::string_view compression, std::span<const std::byte> bytes,
                          uint64_t size);

}  // namespace engram::datasets::mcap
