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

/// Compresses the records of a chunk: "zstd", "lz4" (frames) or "" (not compressed).
/// Errors: kInvalidArgument naming the compressions that exist.
Result<std::string> compress(std::string_view compression, std::span<const std::byte> bytes);

/// Decompresses the records of a chunk. Nothing is allocated if `bytes` cannot expand to `size`.
/// Errors: kDataLoss if the result has more or fewer than `size` bytes; kInvalidArgument for
/// another compression.
Result<Buffer> decompress(std::string_view compression, std::span<const std::byte> bytes,
                          uint64_t size);

}  // namespace engram::datasets::mcap
