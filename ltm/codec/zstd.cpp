// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/zstd.h"

// Needed for a parameter that is not in the stable API: at negative levels, literals are entropy
// coded only on request.
#define ZSTD_STATIC_LINKING_ONLY
#include <zstd.h>

#include <memory>

namespace engram::ltm {

namespace {

/// Bounds for the expansion of a frame: a block takes at least 3 bytes and gives at most 128 KiB.
constexpr size_t kLargestBlockBytes = 128 << 10;
constexpr size_t kSmallestBlockBytes = 3;
/// A negative level is the number of bytes that are skipped after each failed search for a
/// repetition.
constexpr int kEntropyOnlyLevel = -20'000;
constexpr size_t kWorthSearching = 5;

struct ContextFreer {
  void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
  void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
};

// Creating a context costs more than compressing a small value, so each thread keeps one of each
// kind. The output does not depend on earlier use.
ZSTD_CCtx* compressor() {
  thread_local const std::unique_ptr<ZSTD_CCtx, ContextFreer> context(ZSTD_createCCtx());
  ENGRAM_CHECK(context != nullptr, "zstd: no memory");
  return context.get();
}

ZSTD_DCtx* decompressor() {
  thread_local const std::unique_ptr<ZSTD_DCtx, ContextFreer> context(ZSTD_createDCtx());
  ENGRAM_CHECK(context != nullptr, "zstd: no memory");
  return context.get();
}

}  // namespace

std::vector<std::byte> compress_zstd(std::span<const std::byte> bytes, int level) {
  std::vector<std::byte> out(ZSTD_compressBound(bytes.size()));
  const size_t size =
      ZSTD_compressCCtx(compressor(), out.data(), out.size(), bytes.data(), bytes.size(), level);
  ENGRAM_CHECK(ZSTD_isError(size) == 0, "zstd: {}", ZSTD_getErrorName(size));
  out.resize(size);
  return out;
}

void append_residuals(std::span<const std::byte> bytes, std::vector<std::byte>& out) {
  ZSTD_CCtx* const context = compressor();
  ZSTD_CCtx_reset(context, ZSTD_reset_session_and_parameters);
  ZSTD_CCtx_setParameter(context, ZSTD_c_compressionLevel, kEntropyOnlyLevel);
  ZSTD_CCtx_setParameter(context, ZSTD_c_literalCompressionMode, ZSTD_lcm_huffman);
  // Compress into a temporary buffer, because `out` would keep the capacity for the worst case.
  const size_t max = ZSTD_compressBound(bytes.size());
  const auto frame = std::make_unique_for_overwrite<std::byte[]>(max);
  const size_t size = ZSTD_compress2(context, frame.get(), max, bytes.data(), bytes.size());
  ENGRAM_CHECK(ZSTD_isError(size) == 0, "zstd: {}", ZSTD_getErrorName(size));
  std::span<const std::byte> smaller(frame.get(), size);
  std::vector<std::byte> searched;
  if (size <= bytes.size() / kWorthSearching) {
    searched = compress_zstd(bytes, 1);
    if (searched.size() < size) smaller = searched;
  }
  out.reserve(out.size() + smaller.size());
  out.insert(out.end(), smaller.begin(), smaller.end());
}

Result<size_t> zstd_content_size(std::span<const std::byte> bytes, size_t max_size) {
  const unsigned long long announced = ZSTD_getFrameContentSize(bytes.data(), bytes.size());
  if (announced == ZSTD_CONTENTSIZE_ERROR || announced == ZSTD_CONTENTSIZE_UNKNOWN)
    return data_loss("{} bytes are no zstd frame of known size", bytes.size());
  if (announced > max_size)
    return data_loss("zstd frame announces {} bytes, at most {} fit", announced, max_size);
  if (announced / kLargestBlockBytes > bytes.size() / kSmallestBlockBytes)
    return data_loss("zstd frame of {} bytes announces {}: more than it can hold", bytes.size(),
                     announced);
  return static_cast<size_t>(announced);
}

Status decompress_zstd(std::span<const std::byte> bytes, std::span<std::byte> out) {
  const size_t size =
      ZSTD_decompressDCtx(decompressor(), out.data(), out.size(), bytes.data(), bytes.size());
  if (ZSTD_isError(size) != 0) return data_loss("zstd frame: {}", ZSTD_getErrorName(size));
  if (size != out.size()) return data_loss("zstd frame: has {} bytes, needs {}", size, out.size());
  return {};
}

Result<std::vector<std::byte>> decompress_zstd(std::span<const std::byte> bytes, size_t max_size) {
  ENGRAM_ASSIGN_OR_RETURN(const size_t size, zstd_content_size(bytes, max_size));
  std::vector<std::byte> out(size);
  ENGRAM_RETURN_IF_ERROR(decompress_zstd(bytes, std::span(out)));
  return out;
}

}  // namespace engram::ltm
