// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/png.h"

#include <array>
#include <cstring>
#include <opencv2/imgcodecs.hpp>

#include "ltm/codec/cv_image.h"

namespace engram::ltm {

namespace {

constexpr std::array<uint8_t, 16> kPngStart{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n',
                                            0,    0,   0,   13,  'I',  'H',  'D',  'R'};
constexpr size_t kHeaderBytes = 26;
constexpr int64_t kMaxSide = 1 << 15;
/// Deflate expands no byte further than this.
constexpr size_t kMostExpansion = 1032;
constexpr int kFastest = -1;

uint32_t big_endian(std::span<const std::byte> bytes, size_t at) {
  uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, sizeof(value));
  return __builtin_bswap32(value);
}

/// The header must announce the size that is needed, before anything is decoded.
bool announces(std::span<const std::byte> bytes, const idf::Shape& shape) {
  return bytes.size() >= kHeaderBytes &&
         std::memcmp(bytes.data(), kPngStart.data(), kPngStart.size()) == 0 &&
         big_endian(bytes, 16) == static_cast<uint64_t>(shape[1]) &&
         big_endian(bytes, 20) == static_cast<uint64_t>(shape[0]);
}

class PngCodec final : public Codec {
 public:
  explicit PngCodec(int level = kFastest) : level_(level) {}

  [[nodiscard]] std::string_view name() const override { return "png"; }
  [[nodiscard]] bool is_lossless() const override { return true; }

  [[nodiscard]] bool accepts(idf::ElementType type, const idf::Shape& shape) const override {
    return cv_image::fits(type, shape, kMaxSide, true);
  }

  Result<std::vector<std::byte>> encode(const idf::NdArray& array) const override {
    if (!accepts(array.type(), array.shape()))
      return invalid_argument("png: needs uint8 [H, W, 3], uint8 or uint16 [H, W, 1], found {} {}",
                              to_string(array.type()), idf::to_string(array.shape()));
    std::vector<int> parameters;
    if (level_ != kFastest) parameters = {cv::IMWRITE_PNG_COMPRESSION, level_};
    return cv_image::encode("png", array, parameters);
  }

  Result<idf::NdArray> decode(std::span<const std::byte> bytes, idf::ElementType type,
                              const idf::Shape& shape) const override {
    if (!accepts(type, shape) || !announces(bytes, shape) ||
        *idf::size_bytes(type, shape) / kMostExpansion > bytes.size())
      return data_loss("png: {} bytes hold no {} {}", bytes.size(), to_string(type),
                       idf::to_string(shape));
    return cv_image::decode("png", bytes, type, shape);
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
