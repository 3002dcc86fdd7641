// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/png.h"

#include <array>
#include <bit>
#include <cstring>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace engram::ltm {

namespace {

constexpr std::array<uint8_t, 16> kPngStart{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n',
                                            0,    0,   0,   13,  'I',  'H',  'D',  'R'};
constexpr size_t kHeaderBytes = 26;
constexpr int64_t kMaxSide = 1 << 15;
/// Deflate expands no byte further than this.
constexpr size_t kMostExpansion = 1032;

int cv_type(idf::ElementType type, const idf::Shape& shape) {
  return CV_MAKETYPE(type == idf::ElementType::kUInt16 ? CV_16U : CV_8U,
                     static_cast<int>(shape[2]));
}

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
  [[nodiscard]] std::string_view name() const override { return "png"; }
  [[nodiscard]] bool is_lossless() const override { return true; }

  [[nodiscard]] bool accepts(idf::ElementType type, const idf::Shape& shape) const override {
    if (shape.size() != 3 || shape[0] < 1 || shape[1] < 1 || shape[0] > kMaxSide ||
        shape[1] > kMaxSide)
      return false;
    return type == idf::ElementType::kUInt8 ? shape[2] == 1 || shape[2] == 3
                                            : type == idf::ElementType::kUInt16 && shape[2] == 1;
  }

  Result<std::vector<std::byte>> encode(const idf::NdArray& array) const override {
    const idf::Shape& shape = array.shape();
    if (!accepts(array.type(), shape))
      return invalid_argument("png: needs uint8 [H, W, 3], uint8 or uint16 [H, W, 1], found {} {}",
                              to_string(array.type()), idf::to_string(shape));
    try {
      // cv::Mat has no const view; it is only read.
      const cv::Mat view(static_cast<int>(shape[0]), static_cast<int>(shape[1]),
                         cv_type(array.type(), shape),
                         const_cast<std::byte*>(array.bytes().data()));
      // Into a Mat of its own: one that shares the view's pixels would be changed in place.
      cv::Mat bgr;
      if (shape[2] == 3)
        cv::cvtColor(view, bgr, cv::COLOR_RGB2BGR);
      else
        bgr = view;
      std::vector<uchar> png;
      if (!cv::imencode(".png", bgr, png)) return invalid_argument("png: the encoder refused");
      const auto bytes = std::as_bytes(std::span(png));
      return std::vector<std::byte>(bytes.begin(), bytes.end());
    } catch (const cv::Exception& error) {
      return invalid_argument("png: {}", error.what());
    }
  }

  Result<idf::NdArray> decode(std::span<const std::byte> bytes, idf::ElementType type,
                              const idf::Shape& shape) const override {
    if (!accepts(type, shape) || !announces(bytes, shape) ||
        *idf::size_bytes(type, shape) / kMostExpansion > bytes.size())
      return data_loss("png: {} bytes hold no {} {}", bytes.size(), to_string(type),
                       idf::to_string(shape));
    try {
      const cv::Mat packed(1, static_cast<int>(bytes.size()), CV_8U,
                           const_cast<std::byte*>(bytes.data()));
      cv::Mat image = cv::imdecode(packed, cv::IMREAD_UNCHANGED);
      if (image.rows != shape[0] || image.cols != shape[1] || image.type() != cv_type(type, shape))
        return data_loss("png: damaged, or not {} {}", to_string(type), idf::to_string(shape));
      std::vector<std::byte> plain(image.total() * image.elemSize());
      cv::Mat out(image.rows, image.cols, image.type(), plain.data());
      if (shape[2] == 3)
        cv::cvtColor(image, out, cv::COLOR_BGR2RGB);
      else
        image.copyTo(out);
      return idf::NdArray::create(type, shape, Buffer::take(std::move(plain)));
    } catch (const cv::Exception& error) {
      return data_loss("png: {}", error.what());
    }
  }
};

}  // namespace

const Codec& png_codec() {
  static const PngCodec codec;
  return codec;
}

}  // namespace engram::ltm
