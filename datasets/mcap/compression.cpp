// SPDX-License-Identifier: Apache-2.0
#include "datasets/mcap/compression.h"

#include <lz4frame.h>

#include <memory>

#include "datasets/mcap/records.h"
#include "ltm/codec/zstd.h"

namespace engram::datasets::mcap {

namespace {

/// How many bytes one of a block that only repeats may stand for.
constexpr uint64_t kMostZstdExpansion = 1 << 16;
constexpr uint64_t kMostLz4Expansion = 256;

struct Lz4Deleter {
  void operator()(LZ4F_dctx* context) const { LZ4F_freeDecompressionContext(context); }
};

Result<std::string> compress_lz4(std::span<const std::byte> bytes) {
  std::string out(LZ4F_compressFrameBound(bytes.size(), nullptr), '\0');
  const size_t size =
      LZ4F_compressFrame(out.data(), out.size(), bytes.data(), bytes.size(), nullptr);
  if (LZ4F_isError(size) != 0) return invalid_argument("lz4: {}", LZ4F_getErrorName(size));
  out.resize(size);
  return out;
}

Status decompress_lz4(std::span<const std::byte> bytes, std::span<std::byte> out) {
  LZ4F_dctx* made = nullptr;
  if (const auto code = LZ4F_createDecompressionContext(&made, LZ4F_VERSION);
      LZ4F_isError(code) != 0)
    return resource_exhausted("lz4: {}", LZ4F_getErrorName(code));
  const std::unique_ptr<LZ4F_dctx, Lz4Deleter> context(made);
  while (!bytes.empty()) {
    size_t taken = bytes.size();
    size_t made_bytes = out.size();
    const size_t code =
        LZ4F_decompress(made, out.data(), &made_bytes, bytes.data(), &taken, nullptr);
    if (LZ4F_isError(code) != 0) return data_loss("lz4 frame: {}", LZ4F_getErrorName(code));
    if (taken == 0 && made_bytes == 0) return data_loss("lz4 frame: has more bytes than it says");
    bytes = bytes.subspan(taken);
    out = out.subspan(made_bytes);
  }
  if (!out.empty()) return data_loss("lz4 frame: {} bytes are missing", out.size());
  return {};
}

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
  const uint64_t most = bytes.size() * (is_lz4 ? kMostLz4Expansion : kMostZstdExpansion);
  if (size > most || size > kMostRecordBytes)
    return data_loss("{} bytes of {} hold no {} bytes", bytes.size(), compression, size);
  // Not set to zero first: what is claimed costs nothing until it is filled.
  const std::shared_ptr<std::byte[]> plain(new std::byte[size]);
  const std::span<std::byte> out(plain.get(), size);
  ENGRAM_RETURN_IF_ERROR(is_lz4 ? decompress_lz4(bytes, out) : ltm::decompress_zstd(bytes, out));
  return Buffer(plain, out);
}

}  // namespace engram::datasets::mcap
