// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

#include "ltm/core/status.h"

namespace engram::ltm {

/// XXH3, 64 bits: finds damage, does not resist forgery.
[[nodiscard]] uint64_t checksum(std::span<const std::byte> bytes);

/// The checksum of a file, read in pieces.
Result<uint64_t> checksum_of_file(const std::filesystem::path& path);

}  // namespace engram::ltm
