// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/jpeg.h"

#include "ltm/codec/file_image.h"
#include "ltm/codec/jpeg_file.h"

namespace engram::ltm {

namespace {

constexpr int64_t kMaxJpegSide = 65'500;
constexpr int kDefaultQuality = 90;

/// True if the file is complete. Decoders fill the missing part of a truncated file with grey and
/// report no error.
bool is_whole(std::span<const std::byte> bytes) {
  return bytes.size() >= 4 && bytes[bytes.size() - 2] == std::byte{0xff} &&
         bytes[bytes.size() - 1] == std::byte{0xd9};
}

class JpegCodec final : public Codec {
 public:
  explicit JpegCodec(int quality) : quality_(quality) {}

  [[nodiscard]] std::string_view name() const override { return "jpeg"; }
  [[nodiscard]] bool is_lossless() const override { return false; }
  [[nodiscard]] double psnr_db() const override { return quality_ >= 90 ? 35 : 20; }

  [[nodiscard]] bool accepts(idf::ElementType type, const idf::Shape& shape) const override {
    return is_file_image(type, shape, kMaxJpegSide, false);
  }

  Result<std::vector<std::byte>> encode(const idf::NdArray& array) const override {
    if (!accepts(array.type(), array.shape()))
      return invalid_argument("jpeg: needs uint8 [H, W, 3] or [H, W, 1], found {} {}",
                              to_string(array.type()), idf::to_string(array.shape()));
    return write_jpeg(array, quality_);
  }

  Result<idf::NdArray> decode(std::span<const std::byte> bytes, idf::ElementType type,
                              const idf::Shape& shape) const override {
    const auto found = announced_image(bytes);
    if (!accepts(type, shape) || !is_whole(bytes) || !found || found->shape != shape)
      return data_loss("jpeg: {} bytes hold no {} {}", bytes.size(), to_string(type),
                       idf::to_string(shape));
    return read_announced(bytes, *found, read_jpeg);
  }

 private:
  int quality_;
};

}  // namespace

Result<std::unique_ptr<const Codec>> make_jpeg_codec(CodecText text) {
  ENGRAM_ASSIGN_OR_RETURN(const int quality, text.take("quality", true, kDefaultQuality, 1, 100));
  ENGRAM_RETURN_IF_ERROR(text.finish());
  return std::unique_ptr<const Codec>(std::make_unique<JpegCodec>(quality));
}

}  // namespace engram::ltm
