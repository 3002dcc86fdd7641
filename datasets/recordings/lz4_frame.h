// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "ltm/core/status.h"

namespace engram::datasets {

/// How many bytes one byte of LZ4 stands for at most.
inline constexpr uint64_t kMaxLz4Expansion = 256;

/// What readers of a format need of a frame. roslz4 of ROS 1 needs both.
struct Lz4FrameOptions {
  /// Each block of 64 KiB is compressed without those before it, which takes more room.
  bool has_independent_blocks = false;
  /// Of all bytes; four behind them.
  bool has_checksum = false;
};

/// One LZ4 frame. Errors: kInvalidArgument.
Result<std::string> compress_lz4(std::span<const std::byte> bytes,
                                 const Lz4FrameOptions& options = {});

/// Frames that hold exactly `out`. Errors: kDataLoss where they hold more or fewer bytes;
/// kResourceExhausted.
Status decompress_lz4(std::span<const std::byte> bytes, std::span<std::byte> out);

}  // namespace engram::datasets
