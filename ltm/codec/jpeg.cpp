// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/jpeg.h"

#include <opencv2/imgcodecs.hpp>
#include <optional>

#include "ltm/codec/cv_image.h"

namespace engram::ltm {

namespace {

constexpr int64_t kMaxSide = 65'500;
constexpr int kDefaultQuality = 90;
/// A block of 8 x 8 takes at least this share of a byte in the densest progressive file; an upper
/// bound of what can come out of few bytes.
constexpr size_t kMostExpansion = 4096;

struct Announced {
  int64_t height = 0;
  int64_t width = 0;
  int64_t channels = 0;
};

/// Decoders fill in grey where the file was cut.
bool is_whole(std::span<const std::byte> bytes) {
  return bytes.size() >= 4 && bytes[bytes.size() - 2] == std::byte{0xff} &&
         bytes[bytes.size() - 1] == std::byte{0xd9};
}

/// The size in the frame header (SOF marker), before anything is decoded.
std::optional<Announced> announced(std::span<const std::byte> bytes) {
  const auto at = [&](size_t i) { return std::to_integer<int64_t>(bytes[i]); };
  const auto pair = [&](size_t i) { return at(i) << 8 | at(i + 1); };
  if (bytes.size() < 4 || pair(0) != 0xffd8) return std::nullopt;
  for (size_t i = 2; i + 10 <= bytes.size();) {
    if (at(i) != 0xff) return std::nullopt;
    const int64_t marker = at(i + 1);
    const bool is_frame =
        marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
    if (is_frame) return Announced{pair(i + 5), pair(i + 7), at(i + 9)};
    const int64_t length = pair(i + 2);
    if (marker < 0xc0 || length < 2) return std::nullopt;
    i += 2 + static_cast<size_t>(length);
  }
  return std::nullopt;
}

class JpegCodec final : public Codec {
 public:
  explicit JpegCodec(int quality) : quality_(quality) {}

  [[nodiscard]] std::string_view name() const override { return "jpeg"; }
  [[nodiscard]] bool is_lossless() const override { return false; }
  [[nodiscard]] double psnr_db() const override { return quality_ >= 90 ? 35 : 20; }

  [[nodiscard]] bool accepts(idf::ElementType type, const idf::Shape& shape) const override {
    return cv_image::fits(type, shape, kMaxSide, false);
  }

  Result<std::vector<std::byte>> encode(const idf::NdArray& array) const override {
    if (!accepts(array.type(), array.shape()))
      return invalid_argument("jpeg: needs uint8 [H, W, 3] or [H, W, 1], found {} {}",
                              to_string(array.type()), idf::to_string(array.shape()));
    return cv_image::encode("jpg", array, {cv::IMWRITE_JPEG_QUALITY, quality_});
  }

  Result<idf::NdArray> decode(std::span<const std::byte> bytes, idf::ElementType type,
                              const idf::Shape& shape) const override {
    const auto found = announced(bytes);
    if (!accepts(type, shape) || !is_whole(bytes) || !found || found->height != shape[0] ||
        found->width != shape[1] || found->channels != shape[2] ||
        *idf::size_bytes(type, shape) / kMostExpansion > bytes.size())
      return data_loss("jpeg: {} bytes hold no {} {}", bytes.size(), to_string(type),
                       idf::to_string(shape));
    return cv_image::decode("jpg", bytes, type, shape);
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
