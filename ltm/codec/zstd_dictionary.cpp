// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/zstd_dictionary.h"

// Frames without a magic number and shared tables are not in the stable API.
#define ZSTD_STATIC_LINKING_ONLY
#include <zdict.h>
#include <zstd.h>

namespace engram::ltm {

namespace {

constexpr size_t kMinDictionary = 256;
constexpr size_t kMaxDictionary = 1 << 20;

template <auto kFree>
struct Freer {
  template <typename T>
  void operator()(T* object) const {
    kFree(object);
  }
};
using Compressor = std::unique_ptr<ZSTD_CCtx, Freer<ZSTD_freeCCtx>>;
using Decompressor = std::unique_ptr<ZSTD_DCtx, Freer<ZSTD_freeDCtx>>;

Compressor make_compressor() {
  Compressor context(ZSTD_createCCtx());
  ENGRAM_CHECK(context != nullptr, "zstd: no memory");
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_format, ZSTD_f_zstd1_magicless);
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_dictIDFlag, 0);
  return context;
}

Decompressor make_decompressor() {
  Decompressor context(ZSTD_createDCtx());
  ENGRAM_CHECK(context != nullptr, "zstd: no memory");
  ZSTD_DCtx_setParameter(context.get(), ZSTD_d_format, ZSTD_f_zstd1_magicless);
  return context;
}

}  // namespace

struct ZstdDictionary::Tables {
  std::unique_ptr<ZSTD_CDict, Freer<ZSTD_freeCDict>> compressing;
  std::unique_ptr<ZSTD_DDict, Freer<ZSTD_freeDDict>> decompressing;
};

Status ZstdDictionary::Options::validate() const {
  if (max_bytes < kMinDictionary || max_bytes > kMaxDictionary)
    return invalid_argument("dictionary of at most {} bytes, needs {} to {}", max_bytes,
                            kMinDictionary, kMaxDictionary);
  if (level < 1 || level > 19)
    return invalid_argument("dictionary of level {}, needs 1 to 19", level);
  return {};
}

Result<ZstdDictionary> ZstdDictionary::train(std::span<const Buffer> samples,
                                             const Options& options) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  std::vector<std::byte> all;
  std::vector<size_t> sizes;
  for (const Buffer& sample : samples) {
    all.insert(all.end(), sample.bytes().begin(), sample.bytes().end());
    sizes.push_back(sample.size());
  }
  std::vector<std::byte> bytes(options.max_bytes);
  const size_t size = ZDICT_trainFromBuffer(bytes.data(), bytes.size(), all.data(), sizes.data(),
                                            static_cast<unsigned>(sizes.size()));
  if (ZDICT_isError(size) != 0)
    return invalid_argument("dictionary: {} samples of {} bytes teach nothing: {}", sizes.size(),
                            all.size(), ZDICT_getErrorName(size));
  bytes.resize(size);
  return from_bytes(Buffer::take(std::move(bytes)), options.level);
}

Result<ZstdDictionary> ZstdDictionary::from_bytes(Buffer bytes, int level) {
  const uint32_t id = ZSTD_getDictID_fromDict(bytes.data(), bytes.size());
  if (id == 0 || bytes.size() > kMaxDictionary)
    return data_loss("{} bytes are no dictionary", bytes.size());
  auto tables = std::make_shared<Tables>();
  tables->compressing.reset(ZSTD_createCDict(bytes.data(), bytes.size(), level));
  tables->decompressing.reset(ZSTD_createDDict(bytes.data(), bytes.size()));
  if (tables->compressing == nullptr || tables->decompressing == nullptr)
    return data_loss("dictionary {} of {} bytes is damaged", id, bytes.size());
  return ZstdDictionary(std::move(bytes), id, std::move(tables));
}

std::vector<std::byte> ZstdDictionary::compress(std::span<const std::byte> bytes) const {
  // Creating a context takes longer than compressing a small value.
  thread_local const Compressor context = make_compressor();
  ZSTD_CCtx_refCDict(context.get(), tables_->compressing.get());
  std::vector<std::byte> out(ZSTD_compressBound(bytes.size()));
  const size_t size =
      ZSTD_compress2(context.get(), out.data(), out.size(), bytes.data(), bytes.size());
  // The thread's context outlives this dictionary and must not keep a pointer to its tables.
  ZSTD_CCtx_refCDict(context.get(), nullptr);
  ENGRAM_CHECK(ZSTD_isError(size) == 0, "zstd: {}", ZSTD_getErrorName(size));
  return {out.begin(), out.begin() + static_cast<ptrdiff_t>(size)};
}

Result<std::vector<std::byte>> ZstdDictionary::decompress(std::span<const std::byte> bytes,
                                                          size_t max_size) const {
  ZSTD_frameHeader header;
  if (ZSTD_getFrameHeader_advanced(&header, bytes.data(), bytes.size(), ZSTD_f_zstd1_magicless) !=
          0 ||
      header.frameContentSize == ZSTD_CONTENTSIZE_UNKNOWN)
    return data_loss("{} bytes are no frame of dictionary {}", bytes.size(), id_);
  if (header.frameContentSize > max_size)
    return data_loss("frame of dictionary {} announces {} bytes, at most {} fit", id_,
                     header.frameContentSize, max_size);
  // A block of 3 bytes gives at most 128 KiB.
  if (header.frameContentSize >> 17 > bytes.size() / 3)
    return data_loss("frame of dictionary {} announces more than it can hold", id_);
  thread_local const Decompressor context = make_decompressor();
  std::vector<std::byte> out(header.frameContentSize);
  ZSTD_DCtx_refDDict(context.get(), tables_->decompressing.get());
  const size_t size =
      ZSTD_decompressDCtx(context.get(), out.data(), out.size(), bytes.data(), bytes.size());
  ZSTD_DCtx_refDDict(context.get(), nullptr);
  if (ZSTD_isError(size) != 0 || size != out.size())
    return data_loss("frame of dictionary {}: {}", id_,
                     ZSTD_isError(size) != 0 ? ZSTD_getErrorName(size) : "too short");
  return out;
}

}  // namespace engram::ltm
