// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

namespace engram::ltm {

/// Reorders bytes: the first bytes of all records, then all second bytes, and so on. In similar
/// numbers these bytes are similar too, so they compress better. Bytes after the last whole record
/// stay in place. Needs record_bytes >= 1 and out.size() == bytes.size() (checked).
void shuffle_bytes(std::span<const std::byte> bytes, size_t record_bytes, std::span<std::byte> out);
void unshuffle_bytes(std::span<const std::byte> bytes, size_t record_bytes,
                     std::span<std::byte> out);

/// Reorders bits: bit 0 of the first bytes of all records, then bit 1, and so on. Records are
/// handled in groups of eight; the remaining ones stay as they are.
void shuffle_bits(std::span<const std::byte> bytes, size_t record_bytes, std::span<std::byte> out);
void unshuffle_bits(std::span<const std::byte> bytes, size_t record_bytes,
                    std::span<std::byte> out);

}  // namespace engram::ltm
