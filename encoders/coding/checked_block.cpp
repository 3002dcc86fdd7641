// SPDX-License-Identifier: Apache-2.0
#include "encoders/coding/checked_block.h"

#include <xxhash.h>

namespace engram::encoders {

namespace {

constexpr size_t kChecksumBytes = 4;

uint32_t checksum_of(std::span<const std::byte> bytes, uint64_t count) {
  return static_cast<uint32_t>(XXH3_64bits_withSeed(bytes.data(), bytes.size(), count));
}

}  // namespace

std::vector<std::byte> with_checksum(std::vector<std::byte> bytes, uint64_t count) {
  const uint32_t checksum = checksum_of(bytes, count);
  for (size_t i = 0; i < kChecksumBytes; ++i)
    bytes.push_back(std::byte(static_cast<uint8_t>(checksum >> (8 * i))));
  return bytes;
}

Result<std::span<const std::byte>> without_checksum(std::span<const std::byte> bytes,
                                                    std::string_view what, uint64_t count) {
  if (bytes.size() < kChecksumBytes)
    return data_loss("{}: found {} bytes, needs at least {}", what, bytes.size(), kChecksumBytes);
  const auto body = bytes.first(bytes.size() - kChecksumBytes);
  uint32_t stored = 0;
  for (size_t i = 0; i < kChecksumBytes; ++i)
    stored |= std::to_integer<uint32_t>(bytes[body.size() + i]) << (8 * i);
  if (stored != checksum_of(body, count))
    return data_loss("{}: checksum {:08x} of {} bytes does not fit, needs {:08x}", what,
                     checksum_of(body, count), body.size(), stored);
  return body;
}

Result<std::span<const std::byte>> take_part(std::span<const std::byte>& bytes, int64_t size,
                                             std::string_view what) {
  if (size < 0 || static_cast<uint64_t>(size) > bytes.size())
    return data_loss("{}: found a part of {} bytes, needs at most {}", what, size, bytes.size());
  const auto part = bytes.first(static_cast<size_t>(size));
  bytes = bytes.subspan(part.size());
  return part;
}

}  // namespace engram::encoders
