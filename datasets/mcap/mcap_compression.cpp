// SPDX-License-Identifier: Apache-2.0
#include "datasets/mcap/mcap_compression.h"

#include <memory>

#include "datasets/mcap/mcap_records.h"
#include "datasets/recordings/lz4_frame.h"
#include "ltm/codec/zstd.h"

namespace engram::datasets::mcap {

namespace {

/// The maximum number of bytes that one byte of a repetitive block can expand to.
constexpr uint64_t kMaxZstdExpansion = 1 << 16;

}  // namespace

Result<std::string> compress(std::string_view compression, std::span<const std::byte> bytes) {
  if (compression.empty()) return std::string(as_text(bytes));
  if (compression == "lz4") return compress_lz4(bytes);
  if (compression != "zstd")
    return invalid_argument("compression '{}', needs 'zstd', 'lz4' or ''", compression);
  return std::string(as_text(ltm::compress_zstd(bytes, 1)));
}

Result<Buffer> decompress(std::string_view compression, std::span<const std::byte> bytes,
                          uint64_t size) {
  if (compression.empty()) {
    if (bytes.size() != size) return data_loss("{} bytes, needs {}", bytes.size(), size);
    return Buffer::copy(bytes);
  }
  if (compression != "zstd" && compression != "lz4")
    return invalid_argument("compression '{}', needs 'zstd', 'lz4' or ''", compression);
  const bool is_lz4 = compression == "lz4";
  const uint64_t max = bytes.size() * (is_lz4 ? kMaxLz4Expansion : kMaxZstdExpansion);
  if (size > max || size > kMaxRecordBytes)
    return data_loss("{} bytes of {} hold no {} bytes", bytes.size(), compression, size);
  // The memory is not set to zero, so a false size costs nothing until it is filled.
  const std::shared_ptr<std::byte[]> plain(new std::byte[size]);
  const std::span<std::byte> out(plain.get(), size);
  ENGRAM_RETURN_IF_ERROR(is_lz4 ? decompress_lz4(bytes, out) : ltm::decompress_zstd(bytes, out));
  return Buffer(plain, out);
}

}  // namespace engram::datasets::mcap
