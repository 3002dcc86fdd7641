// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

namespace engram::ltm {

/// Lays the first bytes of all records beside each other, then the second ones, and so on: in
/// numbers that resemble each other, those bytes do. What is left behind the last whole record
/// stays where it is. Needs record_bytes >= 1 and out.size() == bytes.size() (checked).
void shuffle_bytes(std::span<const std::byte> bytes, size_t record_bytes, std::span<std::byte> out);
void unshuffle_bytes(std::span<const std::byte> bytes, size_t record_bytes,
                     std::span<std::byte> out);

/// The same with bits: bit 0 of the first bytes of all records, then bit 1, ... In eights of
/// records; those left stay as they are.
void shuffle_bits(std::span<const std::byte> bytes, size_t record_bytes, std::span<std::byte> out);
void unshuffle_bits(std::span<const std::byte> bytes, size_t record_bytes,
                    std::span<std::byte> out);

}  // namespace engram::ltm
