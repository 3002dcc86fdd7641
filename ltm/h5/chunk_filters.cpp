// SPDX-License-Identifier: Apache-2.0
#include "ltm/h5/chunk_filters.h"

#include <zlib.h>

#include <algorithm>

namespace engram::h5 {

namespace {

constexpr size_t kChecksumBytes = 4;

/// Fletcher's checksum over pairs of bytes, high byte first.
uint32_t fletcher32(RawView bytes) {
  uint32_t a = 0;
  uint32_t b = 0;
  for (size_t i = 0; i < bytes.size(); i += 2) {
    const auto high = std::to_integer<uint32_t>(bytes[i]) << 8;
    a += high | (i + 1 < bytes.size() ? std::to_integer<uint32_t>(bytes[i + 1]) : 0);
    a = (a & 0xFFFF) + (a >> 16);
    b += a;
    b = (b & 0xFFFF) + (b >> 16);
  }
  return b << 16 | a;
}

Result<RawBytes> checked(RawBytes bytes) {
  if (bytes.size() < kChecksumBytes) return data_loss("a chunk has no checksum");
  const auto stated = raw_number<uint32_t>(bytes, bytes.size() - kChecksumBytes);
  bytes.resize(bytes.size() - kChecksumBytes);
  const uint32_t sum = fletcher32(bytes);
  // Modulo 65535, zero and all ones are the same, and either half may be written as either.
  const auto is_same = [](uint32_t x, uint32_t y) {
    return (x & 0xFFFF) % 0xFFFF == (y & 0xFFFF) % 0xFFFF;
  };
  if (!is_same(sum, stated) || !is_same(sum >> 16, stated >> 16))
    return data_loss("a chunk has checksum {:08x}, needs {:08x}", sum, stated);
  return bytes;
}

Result<RawBytes> inflated(const RawBytes& bytes, uint64_t max) {
  RawBytes out(max);
  uLongf size = out.size();
  if (uncompress(reinterpret_cast<Bytef*>(out.data()), &size,
                 reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()) != Z_OK)
    return data_loss("a chunk is no deflated data of up to {} bytes", max);
  out.resize(size);
  return out;
}

RawBytes unshuffled(const RawBytes& bytes, uint64_t element_bytes) {
  const size_t count = bytes.size() / element_bytes;
  RawBytes out(bytes);
  for (size_t byte = 0; byte < element_bytes; ++byte)
    for (size_t i = 0; i < count; ++i) out[i * element_bytes + byte] = bytes[byte * count + i];
  return out;
}

}  // namespace

Result<RawBytes> unfiltered_chunk(RawBytes stored, const std::vector<ChunkFilter>& filters,
                                  uint32_t skipped, uint64_t chunk_bytes, uint64_t element_bytes) {
  for (size_t i = filters.size(); i-- > 0;) {
    if (i < 32 && (skipped >> i & 1) != 0) continue;
    switch (filters[i]) {
      case ChunkFilter::kDeflate: {
        ENGRAM_ASSIGN_OR_RETURN(stored, inflated(stored, chunk_bytes + kChecksumBytes));
        break;
      }
      case ChunkFilter::kFletcher32: {
        ENGRAM_ASSIGN_OR_RETURN(stored, checked(std::move(stored)));
        break;
      }
      case ChunkFilter::kShuffle:
        stored = unshuffled(stored, element_bytes);
        break;
    }
  }
  if (stored.size() != chunk_bytes)
    return data_loss("a chunk has {} bytes, needs {}", stored.size(), chunk_bytes);
  return stored;
}

}  // namespace engram::h5
