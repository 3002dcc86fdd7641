// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/zstd_codec.h"

#include "ltm/codec/zstd.h"

namespace engram::ltm {

namespace {

constexpr int kDefaultLevel = 3;

class ZstdCodec final : public Codec {
 public:
  explicit ZstdCodec(int level = kDefaultLevel) : level_(level) {}

  [[nodiscard]] std::string_view name() const override { return "zstd"; }
  [[nodiscard]] bool is_lossless() const override { return true; }
  [[nodiscard]] bool accepts(idf::ElementType, const idf::Shape&) const override { return true; }

  Result<std::vector<std::byte>> encode(const idf::NdArray& array) const override {
    return compress_zstd(array.bytes(), level_);
  }

  Result<idf::NdArray> decode(std::span<const std::byte> bytes, idf::ElementType type,
                              const idf::Shape& shape) const override {
    const auto size = idf::size_bytes(type, shape);
    if (!size) return data_loss("zstd: shape {} exceeds 64 bits", idf::to_string(shape));
    ENGRAM_ASSIGN_OR_RETURN(std::vector<std::byte> plain, decompress_zstd(bytes, *size));
    if (plain.size() != *size)
      return data_loss("zstd: found {} bytes, {} {} needs {}", plain.size(), to_string(type),
                       idf::to_string(shape), *size);
    return idf::NdArray::create(type, shape, Buffer::take(std::move(plain)));
  }

 private:
  int level_;
};

}  // namespace

Result<std::unique_ptr<const Codec>> make_zstd_codec(CodecText text) {
  ENGRAM_ASSIGN_OR_RETURN(const int level, text.take("level", true, kDefaultLevel, 1, 19));
  ENGRAM_RETURN_IF_ERROR(text.finish());
  return std::unique_ptr<const Codec>(std::make_unique<ZstdCodec>(level));
}

const Codec& zstd_codec() {
  static const ZstdCodec codec;
  return codec;
}

}  // namespace engram::ltm
