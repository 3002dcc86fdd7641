// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/shuffle.h"

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "ltm/core/check.h"

namespace engram::ltm {

namespace {

constexpr size_t kBits = 8;

void check_sizes(size_t bytes, size_t record_bytes, size_t out) {
  ENGRAM_CHECK(record_bytes >= 1 && bytes == out, "records of {}, {} bytes into {}", record_bytes,
               bytes, out);
}

/// Transposes 8 x 8 bits; its own inverse.
uint64_t transposed(uint64_t bits) {
  uint64_t moved = (bits ^ (bits >> 7)) & 0x00aa00aa00aa00aa;
  bits ^= moved ^ (moved << 7);
  moved = (bits ^ (bits >> 14)) & 0x0000cccc0000cccc;
  bits ^= moved ^ (moved << 14);
  moved = (bits ^ (bits >> 28)) & 0x00000000f0f0f0f0;
  return bits ^ moved ^ (moved << 28);
}

}  // namespace

void shuffle_bytes(std::span<const std::byte> bytes, size_t record_bytes,
                   std::span<std::byte> out) {
  check_sizes(bytes.size(), record_bytes, out.size());
  const size_t count = bytes.size() / record_bytes;
  for (size_t b = 0; b < record_bytes; ++b)
    for (size_t i = 0; i < count; ++i) out[b * count + i] = bytes[i * record_bytes + b];
  std::ranges::copy(bytes.subspan(count * record_bytes), out.begin() + count * record_bytes);
}

void unshuffle_bytes(std::span<const std::byte> bytes, size_t record_bytes,
                     std::span<std::byte> out) {
  check_sizes(bytes.size(), record_bytes, out.size());
  const size_t count = bytes.size() / record_bytes;
  for (size_t i = 0; i < count; ++i)
    for (size_t b = 0; b < record_bytes; ++b) out[i * record_bytes + b] = bytes[b * count + i];
  std::ranges::copy(bytes.subspan(count * record_bytes), out.begin() + count * record_bytes);
}

void shuffle_bits(std::span<const std::byte> bytes, size_t record_bytes, std::span<std::byte> out) {
  check_sizes(bytes.size(), record_bytes, out.size());
  const size_t eights = bytes.size() / record_bytes / kBits;
  for (size_t b = 0; b < record_bytes; ++b)
    for (size_t i = 0; i < eights; ++i) {
      uint64_t square = 0;
      for (size_t k = 0; k < kBits; ++k)
        square |= std::to_integer<uint64_t>(bytes[(i * kBits + k) * record_bytes + b])
                  << (kBits * k);
      square = transposed(square);
      for (size_t k = 0; k < kBits; ++k)
        out[(b * kBits + k) * eights + i] = static_cast<std::byte>(square >> (kBits * k));
    }
  const size_t done = eights * kBits * record_bytes;
  std::ranges::copy(bytes.subspan(done), out.begin() + done);
}

void unshuffle_bits(std::span<const std::byte> bytes, size_t record_bytes,
                    std::span<std::byte> out) {
  check_sizes(bytes.size(), record_bytes, out.size());
  const size_t eights = bytes.size() / record_bytes / kBits;
  for (size_t b = 0; b < record_bytes; ++b)
    for (size_t i = 0; i < eights; ++i) {
      uint64_t square = 0;
      for (size_t k = 0; k < kBits; ++k)
        square |= std::to_integer<uint64_t>(bytes[(b * kBits + k) * eights + i]) << (kBits * k);
      square = transposed(square);
      for (size_t k = 0; k < kBits; ++k)
        out[(i * kBits + k) * record_bytes + b] = static_cast<std::byte>(square >> (kBits * k));
    }
  const size_t done = eights * kBits * record_bytes;
  std::ranges::copy(bytes.subspan(done), out.begin() + done);
}

}  // namespace engram::ltm
