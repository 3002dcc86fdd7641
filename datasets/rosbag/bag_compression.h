// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "ltm/core/buffer.h"
#include "ltm/core/status.h"

namespace engram::datasets::rosbag {

/// Errors: kInvalidArgument naming the compressions that exist.
Status check_compression(std::string_view compression);

/// Compresses the records of a chunk: "none", "bz2" or "lz4" (frames that roslz4 can read).
/// Errors: those of check_compression; kResourceExhausted.
Result<std::string> compress(std::string_view compression, std::span<const std::byte> bytes);

/// Decompresses the records of a chunk: "none", "bz2" or "lz4" (frames). Memory grows with the
/// actual data, not with the stated size. Errors: kDataLoss if the result has more or fewer than
/// `size` bytes; kInvalidArgument for another compression.
Result<Buffer> decompress(std::string_view compression, std::span<const std::byte> bytes,
                          uint64_t size);

}  // namespace engram::datasets::rosbag
