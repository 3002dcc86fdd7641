// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/rowpred.h"

#include <array>
#include <cstring>
#include <memory>

#include "ltm/codec/row_prediction.h"
#include "ltm/codec/zstd.h"

namespace engram::ltm {

namespace {

constexpr int64_t kMaxRowSide = 1 << 16;
constexpr uint8_t kRowVersion = 1;
/// Max size of the memory that a thread keeps for residuals: an image of 1280 x 720 RGB. Pages that
/// were never written take no memory.
constexpr size_t kKeptRoomBytes = size_t{3} << 20;

/// The header before the Zstandard frame.
struct Header {
  uint8_t version = kRowVersion;
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

/// Allocates memory without zeroing it.
std::shared_ptr<std::byte[]> make_room(size_t bytes) {
  return std::make_unique_for_overwrite<std::byte[]>(bytes);
}

/// Memory for residuals while an image is encoded or decoded. Fresh memory costs as much time as
/// half of the prediction, so each thread keeps some; larger images allocate their own.
class ResidualRoom {
 public:
  explicit ResidualRoom(size_t bytes) : bytes_(bytes) {
    thread_local std::shared_ptr<std::byte[]> kept;
    if (bytes > kKeptRoomBytes) {
      room_ = make_room(bytes);
      return;
    }
    if (kept == nullptr) kept = make_room(kKeptRoomBytes);
    room_ = kept;
  }

  [[nodiscard]] std::span<std::byte> bytes() const { return {room_.get(), bytes_}; }

 private:
  std::shared_ptr<std::byte[]> room_;
  size_t bytes_;
};

class RowpredCodec final : public Codec {
 public:
  [[nodiscard]] std::string_view name() const override { return "rowpred"; }
  [[nodiscard]] bool is_lossless() const override { return true; }

  [[nodiscard]] bool accepts(idf::ElementType type, const idf::Shape& shape) const override {
    if (shape.size() != 3) return false;
    for (const int64_t side : {shape[0], shape[1]})
      if (side < 1 || side > kMaxRowSide) return false;
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
    const ResidualRoom residuals(size.bytes());
    predict_rows(array.bytes(), size, differences, residuals.bytes());
    const auto start = std::as_bytes(std::span(&header, 1));
    std::vector<std::byte> out(start.begin(), start.end());
    append_residuals(residuals.bytes(), out);
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
    const auto frame = bytes.subspan(sizeof(Header));
    ENGRAM_ASSIGN_OR_RETURN(const size_t found, zstd_content_size(frame, size.bytes()));
    if (found != size.bytes())
      return data_loss("rowpred: found {} bytes, needs {}", found, size.bytes());
    const ResidualRoom residuals(size.bytes());
    ENGRAM_RETURN_IF_ERROR(decompress_zstd(frame, residuals.bytes()));
    const std::shared_ptr<std::byte[]> plain = make_room(size.bytes());
    const std::span<std::byte> image(plain.get(), size.bytes());
    restore_rows(residuals.bytes(), size, header.colour_differences == 1, image);
    return idf::NdArray::create(type, shape, Buffer(plain, image));
  }
};

}  // namespace

Result<std::unique_ptr<const Codec>> make_rowpred_codec(CodecText text) {
  ENGRAM_RETURN_IF_ERROR(text.finish());
  return std::unique_ptr<const Codec>(std::make_unique<RowpredCodec>());
}

}  // namespace engram::ltm
