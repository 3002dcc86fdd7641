// SPDX-License-Identifier: Apache-2.0
#include "datasets/recordings/lz4_frame.h"

#include <lz4frame.h>

#include <memory>

namespace engram::datasets {

namespace {

struct Lz4Deleter {
  void operator()(LZ4F_dctx* context) const { LZ4F_freeDecompressionContext(context); }
};

}  // namespace

Result<std::string> compress_lz4(std::span<const std::byte> bytes, const Lz4FrameOptions& options) {
  LZ4F_preferences_t wanted{};
  wanted.frameInfo.blockMode =
      options.has_independent_blocks ? LZ4F_blockIndependent : LZ4F_blockLinked;
  wanted.frameInfo.contentChecksumFlag =
      options.has_checksum ? LZ4F_contentChecksumEnabled : LZ4F_noContentChecksum;
  std::string out(LZ4F_compressFrameBound(bytes.size(), &wanted), '\0');
  const size_t size =
      LZ4F_compressFrame(out.data(), out.size(), bytes.data(), bytes.size(), &wanted);
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

}  // namespace engram::datasets
