// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "ltm/core/status.h"

namespace engram::datasets {

/// How many bytes one byte of LZ4 stands for at most.
inline constexpr uint64_t kMostLz4Expansion = 256;

/// One LZ4 frame. Errors: kInvalidArgument.
Result<std::string> compress_lz4(std::span<const std::byte> bytes);

/// Frames that hold exactly `out`. Errors: kDataLoss where they hold more or fewer bytes;
/// kResourceExhausted.
Status decompress_lz4(std::span<const std::byte> bytes, std::span<std::byte> out);

}  // namespace engram::datasets
