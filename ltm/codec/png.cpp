// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/png.h"

#include "ltm/codec/file_image.h"
#include "ltm/codec/png_file.h"

namespace engram::ltm {

namespace {

constexpr int64_t kMaxPngSide = 1 << 15;
constexpr int kFastest = -1;

class PngCodec final : public Codec {
 public:
  explicit PngCodec(int level = kFastest) : level_(level) {}

  [[nodiscard]] std::string_view name() const override { return "png"; }
  [[nodiscard]] bool is_lossless() const override { return true; }

  [[nodiscard]] bool accepts(idf::ElementType type, const idf::Shape& shape) const override {
    return is_file_image(type, shape, kMaxPngSide, true);
  }

  Result<std::vector<std::byte>> encode(const idf::NdArray& array) const override {
    if (!accepts(array.type(), array.shape()))
      return invalid_argument("png: needs uint8 [H, W, 3], uint8 or uint16 [H, W, 1], found {} {}",
                              to_string(array.type()), idf::to_string(array.shape()));
    return write_png(array, level_ == kFastest ? std::nullopt : std::optional(level_));
  }

  Result<idf::NdArray> decode(std::span<const std::byte> bytes, idf::ElementType type,
                              const idf::Shape& shape) const override {
    const auto found = announced_image(bytes);
    if (!accepts(type, shape) || !found || found->codec != name() || found->type != type ||
        found->shape != shape)
      return data_loss("png: {} bytes hold no {} {}", bytes.size(), to_string(type),
                       idf::to_string(shape));
    return read_announced(bytes, *found, read_png);
  }

 private:
  int level_;
};

}  // namespace

Result<std::unique_ptr<const Codec>> make_png_codec(CodecText text) {
  ENGRAM_ASSIGN_OR_RETURN(const int level, text.take("level", true, kFastest, 0, 9));
  ENGRAM_RETURN_IF_ERROR(text.finish());
  return std::unique_ptr<const Codec>(std::make_unique<PngCodec>(level));
}

const Codec& png_codec() {
  static const PngCodec codec;
  return codec;
}

}  // namespace engram::ltm
