// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/rowpred.h"

#include <array>
#include <cstring>

#include "ltm/codec/row_prediction.h"
#include "ltm/codec/zstd.h"

namespace engram::ltm {

namespace {

constexpr int64_t kMaxSide = 1 << 16;
constexpr uint8_t kVersion = 1;

/// What precedes the Zstandard frame.
struct Header {
  uint8_t version = kVersion;
  uint8_t colour_differences = 0;
  uint8_t channels = 0;
  uint8_t element = 0;  // Code of the element type.
  uint32_t height = 0;
  uint32_t width = 0;

  friend bool operator==(const Header&, const Header&) = default;
};
static_assert(sizeof(Header) == 12);

ImageSize size_of(idf::ElementType type, const idf::Shape& shape) {
  return {.height = static_cast<size_t>(shape[0]),
          .width = static_cast<size_t>(shape[1]),
          .channels = static_cast<size_t>(shape[2]),
          .element_bytes = idf::size_bytes(type),
          .is_float = type == idf::ElementType::kFloat32};
}

Header header_of(idf::ElementType type, const idf::Shape& shape) {
  Header header;
  header.channels = static_cast<uint8_t>(shape[2]);
  header.element = static_cast<uint8_t>(type);
  header.height = static_cast<uint32_t>(shape[0]);
  header.width = static_cast<uint32_t>(shape[1]);
  return header;
}

class RowpredCodec final : public Codec {
 public:
  [[nodiscard]] std::string_view name() const override { return "rowpred"; }
  [[nodiscard]] bool is_lossless() const override { return true; }

  [[nodiscard]] bool accepts(idf::ElementType type, const idf::Shape& shape) const override {
    if (shape.size() != 3) return false;
    for (const int64_t side : {shape[0], shape[1]})
      if (side < 1 || side > kMaxSide) return false;
    if (type == idf::ElementType::kFloat32) return shape[2] == 1;
    return (type == idf::ElementType::kUInt8 || type == idf::ElementType::kUInt16) &&
           shape[2] >= 1 && shape[2] <= 4;
  }

  Result<std::vector<std::byte>> encode(const idf::NdArray& array) const override {
    if (!accepts(array.type(), array.shape()))
      return invalid_argument(
          "rowpred: needs uint8 or uint16 [H, W, 1 to 4] or float32 [H, W, 1], found {} {}",
          to_string(array.type()), idf::to_string(array.shape()));
    const ImageSize size = size_of(array.type(), array.shape());
    Header header = header_of(array.type(), array.shape());
    const bool differences = prefers_colour_differences(array.bytes(), size);
    header.colour_differences = differences ? 1 : 0;
    std::vector<std::byte> residuals(size.bytes());
    predict_rows(array.bytes(), size, differences, residuals);
    std::vector<std::byte> out = compress_residuals(residuals);
    const auto start = std::as_bytes(std::span(&header, 1));
    out.insert(out.begin(), start.begin(), start.end());
    return out;
  }

  Result<idf::NdArray> decode(std::span<const std::byte> bytes, idf::ElementType type,
                              const idf::Shape& shape) const override {
    if (!accepts(type, shape) || bytes.size() < sizeof(Header))
      return data_loss("rowpred: {} bytes hold no {} {}", bytes.size(), to_string(type),
                       idf::to_string(shape));
    Header header;
    std::memcpy(&header, bytes.data(), sizeof(header));
    Header needed = header_of(type, shape);
    needed.colour_differences = header.colour_differences;
    if (header != needed || header.colour_differences > (shape[2] >= 3 ? 1 : 0))
      return data_loss("rowpred: version {}, {} x {} x {} of element type {}, needs {} {}",
                       header.version, header.height, header.width, header.channels, header.element,
                       to_string(type), idf::to_string(shape));
    const ImageSize size = size_of(type, shape);
    ENGRAM_ASSIGN_OR_RETURN(const auto residuals,
                            decompress_zstd(bytes.subspan(sizeof(Header)), size.bytes()));
    if (residuals.size() != size.bytes())
      return data_loss("rowpred: found {} bytes, needs {}", residuals.size(), size.bytes());
    std::vector<std::byte> plain(size.bytes());
    restore_rows(residuals, size, header.colour_differences == 1, plain);
    return idf::NdArray::create(type, shape, Buffer::take(std::move(plain)));
  }
};

}  // namespace

Result<std::unique_ptr<const Codec>> make_rowpred_codec(CodecText text) {
  ENGRAM_RETURN_IF_ERROR(text.finish());
  return std::unique_ptr<const Codec>(std::make_unique<RowpredCodec>());
}

}  // namespace engram::ltm
