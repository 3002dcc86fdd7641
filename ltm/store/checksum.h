// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

#include "ltm/core/status.h"

namespace engram::ltm {

/// The 64-bit XXH3 hash. It detects accidental damage but does not resist forgery.
[[nodiscard]] uint64_t checksum(std::span<const std::byte> bytes);

/// Computes the checksum of a file. The file is read in pieces, so memory stays bounded.
Result<uint64_t> checksum_of_file(const std::filesystem::path& path);

}  // namespace engram::ltm
