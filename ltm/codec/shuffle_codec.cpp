// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/shuffle_codec.h"

#include "ltm/codec/shuffle.h"
#include "ltm/codec/zstd.h"

namespace engram::ltm {

namespace {

constexpr int kDefaultShuffleLevel = 3;
constexpr int64_t kMaxFields = 16;

/// The record size, which is part of the format: docs/codecs.md, section "Formats".
size_t record_bytes(idf::ElementType type, const idf::Shape& shape) {
  const bool has_fields = shape.size() >= 2 && shape.back() >= 1 && shape.back() <= kMaxFields;
  return idf::size_bytes(type) * (has_fields ? static_cast<size_t>(shape.back()) : 1);
}

class ShuffleCodec final : public Codec {
 public:
  explicit ShuffleCodec(int level) : level_(level) {}

  [[nodiscard]] std::string_view name() const override { return "shuffle"; }
  [[nodiscard]] bool is_lossless() const override { return true; }
  [[nodiscard]] bool accepts(idf::ElementType, const idf::Shape&) const override { return true; }

  Result<std::vector<std::byte>> encode(const idf::NdArray& array) const override {
    std::vector<std::byte> shuffled(array.bytes().size());
    shuffle_bytes(array.bytes(), record_bytes(array.type(), array.shape()), shuffled);
    return compress_zstd(shuffled, level_);
  }

  Result<idf::NdArray> decode(std::span<const std::byte> bytes, idf::ElementType type,
                              const idf::Shape& shape) const override {
    const auto size = idf::size_bytes(type, shape);
    if (!size) return data_loss("shuffle: shape {} exceeds 64 bits", idf::to_string(shape));
    ENGRAM_ASSIGN_OR_RETURN(const auto shuffled, decompress_zstd(bytes, *size));
    if (shuffled.size() != *size)
      return data_loss("shuffle: found {} bytes, {} {} needs {}", shuffled.size(), to_string(type),
                       idf::to_string(shape), *size);
    std::vector<std::byte> plain(*size);
    unshuffle_bytes(shuffled, record_bytes(type, shape), plain);
    return idf::NdArray::create(type, shape, Buffer::take(std::move(plain)));
  }

 private:
  int level_;
};

}  // namespace

Result<std::unique_ptr<const Codec>> make_shuffle_codec(CodecText text) {
  ENGRAM_ASSIGN_OR_RETURN(const int level, text.take("level", true, kDefaultShuffleLevel, 1, 19));
  ENGRAM_RETURN_IF_ERROR(text.finish());
  return std::unique_ptr<const Codec>(std::make_unique<ShuffleCodec>(level));
}

}  // namespace engram::ltm
