// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "ltm/core/status.h"

namespace engram::encoders {

/// Appends a checksum of 32 bits (XXH3, truncated, little endian) that finds damage. It also covers
/// `count`, which is not stored, so the reader must know it.
[[nodiscard]] std::vector<std::byte> with_checksum(std::vector<std::byte> bytes,
                                                   uint64_t count = 0);

/// Verifies the checksum and returns the bytes before it. `what` names the bytes in messages.
/// Errors: kDataLoss if the checksum does not fit.
Result<std::span<const std::byte>> without_checksum(std::span<const std::byte> bytes,
                                                    std::string_view what, uint64_t count = 0);

/// Removes the next `size` bytes from `bytes` and returns them. `what` names them in messages.
/// Errors: kDataLoss if there are fewer.
Result<std::span<const std::byte>> take_part(std::span<const std::byte>& bytes, int64_t size,
                                             std::string_view what);

}  // namespace engram::encoders
