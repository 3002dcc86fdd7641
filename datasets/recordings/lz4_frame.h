// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "ltm/core/status.h"

namespace engram::datasets {

/// The maximum number of bytes that one byte of LZ4 can expand to.
inline constexpr uint64_t kMaxLz4Expansion = 256;

/// What readers of a format require of a frame. roslz4 of ROS 1 requires both.
struct Lz4FrameOptions {
  /// Each block of 64 KiB is compressed without reference to earlier blocks, which takes more room.
  bool has_independent_blocks = false;
  /// A checksum of all bytes, four bytes long, follows them.
  bool has_checksum = false;
};

/// Compresses bytes into one LZ4 frame. Errors: kInvalidArgument.
Result<std::string> compress_lz4(std::span<const std::byte> bytes,
                                 const Lz4FrameOptions& options = {});

/// Decompresses frames that hold exactly `out.size()` bytes. Errors: kDataLoss if they hold more or
/// fewer; kResourceExhausted.
Status decompress_lz4(std::span<const std::byte> bytes, std::span<std::byte> out);

}  // namespace engram::datasets
