// SPDX-License-Identifier: Apache-2.0
#include "datasets/ros/image_message.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <optional>

namespace engram::datasets::ros {

namespace {

using idf::ElementType;

/// The meaning of the pixels of an encoding.
struct Encoding {
  std::string_view name;
  ElementType type;
  size_t channels;
  bool is_bgr;
  bool is_depth;
};
constexpr std::array<Encoding, 9> kEncodings{{
    {"rgb8", ElementType::kUInt8, 3, false, false},
    {"bgr8", ElementType::kUInt8, 3, true, false},
    {"mono8", ElementType::kUInt8, 1, false, false},
    {"rgba8", ElementType::kUInt8, 4, false, false},
    {"bgra8", ElementType::kUInt8, 4, true, false},
    {"16UC1", ElementType::kUInt16, 1, false, true},
    {"32FC1", ElementType::kFloat32, 1, false, true},
    {"mono16", ElementType::kUInt16, 1, false, false},
    {"8UC3", ElementType::kUInt8, 3, true, false},
}};

const Encoding* encoding_named(std::string_view name) {
  const auto* found = std::ranges::find(kEncodings, name, &Encoding::name);
  return found == kEncodings.end() ? nullptr : found;
}

/// Returns a whole number from a message.
size_t whole(const idf::Data& message, std::string_view name) {
  const idf::Data* found = message.at(name);
  if (found == nullptr) return 0;
  if (const auto* value = found->get_if<int64_t>()) return *value < 0 ? 0 : *value;
  if (const auto* value = found->get_if<int32_t>()) return *value < 0 ? 0 : *value;
  return 0;
}

/// The layout that the fields of an image message describe, if they agree.
struct Layout {
  const Encoding* encoding;
  size_t height;
  size_t width;
  size_t step;  ///< Distance between rows. Unit: bytes.
  bool swaps;   ///< The byte order differs from the machine's.
  const idf::NdArray* data;

  [[nodiscard]] size_t row_bytes() const {
    return width * encoding->channels * idf::size_bytes(encoding->type);
  }
};

std::optional<Layout> layout_of(const idf::Data& message) {
  const idf::Data* encoding = message.at("encoding");
  const idf::Data* data = message.at("data");
  if (encoding == nullptr || !encoding->is<std::string>() || data == nullptr ||
      !data->is<idf::NdArray>())
    return std::nullopt;
  Layout layout{encoding_named(encoding->get<std::string>()),
                whole(message, "height"),
                whole(message, "width"),
                whole(message, "step"),
                whole(message, "is_bigendian") != 0,
                data->get_if<idf::NdArray>()};
  constexpr size_t kMaxSide = 1 << 24;
  if (layout.encoding == nullptr || layout.data->type() != ElementType::kUInt8 ||
      layout.height == 0 || layout.width == 0 || layout.height > kMaxSide ||
      layout.width > kMaxSide || layout.step < layout.row_bytes() ||
      layout.step > layout.data->buffer().size() ||
      layout.data->buffer().size() != layout.height * layout.step)
    return std::nullopt;
  layout.swaps = layout.swaps && idf::size_bytes(layout.encoding->type) > 1;
  return layout;
}

idf::NdArray array_of(ElementType type, size_t height, size_t width, size_t channels,
                      Buffer buffer) {
  auto array = idf::NdArray::create(
      type,
      {static_cast<int64_t>(height), static_cast<int64_t>(width), static_cast<int64_t>(channels)},
      std::move(buffer));
  ENGRAM_CHECK(array.ok(), "{}", array.status().message());
  return *std::move(array);
}

/// Returns the rows without padding, in the machine's byte order.
Buffer packed_rows(const Layout& layout) {
  if (layout.step == layout.row_bytes() && !layout.swaps &&
      layout.encoding->type == ElementType::kUInt8)
    return layout.data->buffer();
  std::vector<std::byte> packed(layout.height * layout.row_bytes());
  for (size_t y = 0; y < layout.height; ++y)
    std::memcpy(packed.data() + y * layout.row_bytes(),
                layout.data->bytes().data() + y * layout.step, layout.row_bytes());
  const size_t size = idf::size_bytes(layout.encoding->type);
  if (layout.swaps)
    for (size_t i = 0; i < packed.size(); i += size)
      std::reverse(packed.begin() + i, packed.begin() + i + size);
  return Buffer::take(std::move(packed));
}

/// Takes three of `channels` bytes per pixel, and swaps BGR and RGB if `swaps` is true.
Buffer three_of(std::span<const std::byte> pixels, size_t channels, bool swaps) {
  std::vector<std::byte> three(pixels.size() / channels * 3);
  const size_t first = swaps ? 2 : 0;
  const size_t last = 2 - first;
  const std::byte* from = pixels.data();
  for (std::byte* to = three.data(); to != three.data() + three.size(); to += 3) {
    to[0] = from[first];
    to[1] = from[1];
    to[2] = from[last];
    from += channels;
  }
  return Buffer::take(std::move(three));
}

Buffer fourth_of(std::span<const std::byte> pixels) {
  std::vector<std::byte> fourth;
  fourth.reserve(pixels.size() / 4);
  for (size_t i = 3; i < pixels.size(); i += 4) fourth.push_back(pixels[i]);
  return Buffer::take(std::move(fourth));
}

const idf::NdArray* array_member(const idf::Data& value, std::string_view name) {
  const idf::Data* found = value.at(name);
  return found == nullptr ? nullptr : found->get_if<idf::NdArray>();
}

/// Returns the encoding that a picture states, or that its array suggests.
const Encoding* encoding_of(const idf::Data& value, const idf::NdArray& pixels, bool is_depth) {
  const idf::Data* stated = value.at("encoding");
  if (stated != nullptr)
    return stated->is<std::string>() ? encoding_named(stated->get<std::string>()) : nullptr;
  const auto fits = [&](const Encoding& encoding) {
    return encoding.type == pixels.type() && encoding.is_depth == is_depth &&
           static_cast<int64_t>(encoding.channels) == pixels.shape()[2];
  };
  const auto* found = std::ranges::find_if(kEncodings, fits);
  return found == kEncodings.end() ? nullptr : found;
}

/// Returns the pixels as in the message: with alpha, in the order of the encoding.
Result<Buffer> joined(const Encoding& encoding, const idf::NdArray& pixels,
                      const idf::NdArray* alpha) {
  if (encoding.channels != 4 && alpha != nullptr)
    return invalid_argument("encoding '{}' has no place for 'alpha'", encoding.name);
  if (encoding.channels == 3 && encoding.is_bgr) return three_of(pixels.bytes(), 3, true);
  if (encoding.channels != 4) return pixels.buffer();
  if (alpha == nullptr || alpha->type() != ElementType::kUInt8 ||
      alpha->count() != pixels.count() / 3)
    return invalid_argument("encoding '{}' needs 'alpha' of the image's size", encoding.name);
  std::vector<std::byte> four;
  four.reserve(pixels.bytes().size() / 3 * 4);
  const size_t first = encoding.is_bgr ? 2 : 0;
  for (size_t i = 0; i < pixels.bytes().size(); i += 3)
    four.insert(four.end(), {pixels.bytes()[i + first], pixels.bytes()[i + 1],
                             pixels.bytes()[i + 2 - first], alpha->bytes()[i / 3]});
  return Buffer::take(std::move(four));
}

}  // namespace

idf::Data picture_of_image(idf::Data message) {
  const auto layout = layout_of(message);
  if (!layout) return message;
  const Encoding& encoding = *layout->encoding;
  const Buffer rows = packed_rows(*layout);
  const bool copies = encoding.channels == 4 || encoding.is_bgr;
  idf::Dict picture;
  picture.set(
      encoding.is_depth ? "depth" : "image",
      array_of(encoding.type, layout->height, layout->width, std::min<size_t>(encoding.channels, 3),
               copies ? three_of(rows.bytes(), encoding.channels, encoding.is_bgr) : rows));
  if (encoding.channels == 4)
    picture.set("alpha", array_of(ElementType::kUInt8, layout->height, layout->width, 1,
                                  fourth_of(rows.bytes())));
  if (const idf::Data* header = message.at("header")) picture.set("header", *header);
  picture.set("encoding", std::string(encoding.name));
  return picture;
}

Status check_members(const idf::Data& value, std::initializer_list<std::string_view> members) {
  for (const auto& [name, member] : value.get<idf::Dict>())
    if (std::ranges::find(members, name) == members.end())
      return invalid_argument("'{}': an image has no place for it", name);
  if (value.at("image") != nullptr && value.at("depth") != nullptr)
    return invalid_argument("has 'image' and 'depth', needs one of them");
  return {};
}

Result<idf::Data> image_of_picture(const idf::Data& value) {
  const idf::NdArray* depth = array_member(value, "depth");
  const idf::NdArray* pixels = depth != nullptr ? depth : array_member(value, "image");
  if (pixels == nullptr) return value;
  ENGRAM_RETURN_IF_ERROR(check_members(value, {"image", "depth", "alpha", "header", "encoding"}));
  if (pixels->rank() != 3)
    return invalid_argument("image is {}, needs [H, W, channels]", idf::to_string(pixels->shape()));
  const Encoding* encoding = encoding_of(value, *pixels, depth != nullptr);
  if (encoding == nullptr || encoding->type != pixels->type() ||
      std::min<int64_t>(static_cast<int64_t>(encoding->channels), 3) != pixels->shape()[2])
    return invalid_argument("{} {} has no encoding, or another one", to_string(pixels->type()),
                            idf::to_string(pixels->shape()));
  const int64_t height = pixels->shape()[0];
  const int64_t width = pixels->shape()[1];
  ENGRAM_ASSIGN_OR_RETURN(Buffer data, joined(*encoding, *pixels, array_member(value, "alpha")));
  const auto size = static_cast<int64_t>(data.size());
  const idf::Data* header = value.at("header");
  ENGRAM_ASSIGN_OR_RETURN(auto bytes,
                          idf::NdArray::create(ElementType::kUInt8, {size}, std::move(data)));
  return idf::Data(idf::Dict{{"header", header != nullptr ? *header : idf::Data()},
                             {"height", height},
                             {"width", width},
                             {"encoding", std::string(encoding->name)},
                             {"is_bigendian", int32_t{std::endian::native == std::endian::big}},
                             {"step", height == 0 ? int64_t{0} : size / height},
                             {"data", std::move(bytes)}});
}

}  // namespace engram::datasets::ros
